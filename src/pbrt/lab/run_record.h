#pragma once
#include <optional>
#include <string>
#include <vector>

#include "pbrt/lab/measures.h"
#include "pbrt/lab/stopwatch.h"

namespace pbrt::lab {

/// One run at one checkpoint.
struct RoundRecord {
    int checkpoint = 0;
    int samples = 0;  ///< per pixel
    TimeSpent spent;  ///< preparation and rendering; measuring and writing are not counted
    uint64_t shadowRays = 0, shadowRaysBlocked = 0;  ///< of rendering
    Measures measures{};
};

/// One sampler with one seed.
struct RunRecord {
    int seed = 0;
    int expectedSamples = 1;  ///< what the preparation was told
    TimeSpent prepare;
    uint64_t prepareShadowRays = 0;
    nlohmann::ordered_json report = nlohmann::ordered_json::object();  ///< LightSampler::Report at the last checkpoint
    nlohmann::ordered_json gateReport;                                 ///< null without a gate
    std::string structure;
    std::vector<RoundRecord> rounds;  ///< one per checkpoint, in order
};

/// The records of a campaign on disk: a JSON file per sampler, seed and checkpoint, and the film's sums of every run
/// that is not finished. Every file is complete or absent.
class RecordFolder {
  public:
    explicit RecordFolder(std::string folder) : folder_(std::move(folder)) {}
    const std::string &Folder() const { return folder_; }
    /// All rounds of a run from the first on without a gap.
    RunRecord LoadRun(const std::string &sampler, int seed) const;
    void SaveLastRound(const std::string &sampler, const RunRecord &run) const;
    std::string FilmFile(const std::string &sampler, int seed, int checkpoint) const;

    /// Other notes by name (settings, pilot): null if absent or unreadable.
    nlohmann::ordered_json LoadNote(const std::string &name) const;
    void SaveNote(const std::string &name, const nlohmann::ordered_json &note) const;
    std::string File(const std::string &name) const { return folder_ + "/" + name; }

  private:
    std::string RoundFile(const std::string &sampler, int seed, int checkpoint) const;
    std::string folder_;
};

/// Text into a file, as WriteFile does it.
void WriteText(const std::string &path, const std::string &text);

}  // namespace pbrt::lab
