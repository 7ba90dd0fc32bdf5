#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "ext/lab/measures.h"
#include "pbrt/core/progress.h"

namespace ext::lab {

/// Monotonic clock seconds, and CPU seconds of all threads of the process.
struct TimeSpent {
    double wall = 0, cpu = 0;
};

class Stopwatch {
  public:
    TimeSpent Elapsed() const { return {SecondsSince(wall_), ClockSeconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_}; }

  private:
    std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
    double cpu_ = ClockSeconds(CLOCK_PROCESS_CPUTIME_ID);
};

/// Stop condition of a run: a time of its own clock or, if `seconds` is 0, samples per pixel.
struct RenderTarget {
    int samples = 0;
    double seconds = 0;
};

/// One run at one checkpoint.
struct RoundRecord {
    int checkpoint = 0;
    int samples = 0;                                 ///< per pixel
    TimeSpent spent;                                 ///< preparation and rendering, excluding measuring and writing
    uint64_t shadowRays = 0, shadowRaysBlocked = 0;  ///< of rendering
    Measures measures{};
};

struct RunRecord {
    int seed = 0;
    int expectedSamples = 1;  ///< samples per pixel expected by the preparation
    TimeSpent prepare;
    uint64_t prepareShadowRays = 0;
    Json report = Json::object();  ///< LightSampler::Report at the last checkpoint
    std::string structure;
    std::vector<RoundRecord> rounds;  ///< one per checkpoint, in order
    /// Mean over at least one round, excluding the preparation.
    double SecondsPerSample() const {
        return (rounds.back().spent.wall - prepare.wall) / std::max(1, rounds.back().samples);
    }
};

/// Records of an experiment on disk: a JSON file per sampler, seed and checkpoint, and the film sums of unfinished
/// runs. Every JSON file but the settings names its experiment; others, and unreadable ones, count as absent.
class RecordFolder {
  public:
    /// `experiment`: ExperimentKey of the settings.
    RecordFolder(std::string folder, std::string experiment)
        : folder_(std::move(folder)), experiment_(std::move(experiment)) {}
    const std::string &Folder() const { return folder_; }
    /// Loads the rounds of a run up to the first gap, at most `maxRounds`.
    RunRecord LoadRun(const std::string &sampler, int seed, size_t maxRounds) const;
    void SaveLastRound(const std::string &sampler, const RunRecord &run) const;
    std::string FilmFile(const std::string &sampler, int seed, int checkpoint) const {
        return RoundFile(sampler, seed, checkpoint, "film");
    }
    /// One more than the last round with a file, regardless of its content.
    size_t CountRounds(const std::string &sampler, int seed, size_t checkpoints) const;
    /// Removes the files of rounds from `kept` on, and all films but that of round `kept` - 1.
    void RemoveRounds(const std::string &sampler, int seed, size_t kept, size_t checkpoints) const;

    /// Loads the settings of the folder's experiment: null if none, discarded JSON if unreadable.
    Json LoadSettings() const;
    void SaveSettings(const Json &settings) const;
    /// Loads another record by name (pilot, views): null if absent, unreadable or of another experiment.
    Json LoadNote(const std::string &name) const;
    void SaveNote(const std::string &name, const Json &note) const;
    std::string File(const std::string &name) const { return folder_ + "/" + name; }

  private:
    std::string RoundFile(const std::string &sampler, int seed, int checkpoint, const char *kind = "json") const {
        return fmt::format("{}/{}/seed{}-round{:02}.{}", folder_, sampler, seed, checkpoint, kind);
    }
    Json LoadOwn(const std::string &path) const;
    std::string folder_, experiment_;
};

}  // namespace ext::lab
