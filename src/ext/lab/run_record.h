#pragma once
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "ext/lab/measures.h"
#include "ext/lab/stopwatch.h"

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
    int expectedSamples = 1;  ///< samples per pixel that the preparation was told to expect
    TimeSpent prepare;
    uint64_t prepareShadowRays = 0;
    nlohmann::ordered_json report = nlohmann::ordered_json::object();  ///< LightSampler::Report at the last checkpoint
    std::string structure;
    std::vector<RoundRecord> rounds;  ///< one per checkpoint, in order
};

/// The records of a campaign on disk: a JSON file per sampler, seed and checkpoint, and the film's sums of every run
/// that is not finished. Every JSON file but the settings names its campaign; one of another campaign or another
/// version of this program, or one that cannot be read, counts as absent.
class RecordFolder {
  public:
    /// `campaign`: CampaignKey of the settings.
    RecordFolder(std::string folder, std::string campaign)
        : folder_(std::move(folder)), campaign_(std::move(campaign)) {}
    const std::string &Folder() const { return folder_; }
    /// The rounds of a run, from the first one to the first gap, at most `most`.
    RunRecord LoadRun(const std::string &sampler, int seed, int most = std::numeric_limits<int>::max()) const;
    void SaveLastRound(const std::string &sampler, const RunRecord &run) const;
    std::string FilmFile(const std::string &sampler, int seed, int checkpoint) const;
    /// One more than the last round that has a file, whatever is in it.
    size_t CountRounds(const std::string &sampler, int seed, size_t checkpoints) const;
    /// Removes the files of the rounds from `kept` on, and all films but that of round `kept` - 1.
    void RemoveRounds(const std::string &sampler, int seed, size_t kept, size_t checkpoints) const;

    /// The settings of whichever campaign the folder holds: null if there is none, discarded JSON if they cannot be
    /// read.
    nlohmann::ordered_json LoadSettings() const;
    void SaveSettings(const nlohmann::ordered_json &settings) const;
    /// Other notes by name (pilot, views): null if absent, unreadable or of another campaign.
    nlohmann::ordered_json LoadNote(const std::string &name) const;
    void SaveNote(const std::string &name, const nlohmann::ordered_json &note) const;
    std::string File(const std::string &name) const { return folder_ + "/" + name; }

  private:
    std::string RoundFile(const std::string &sampler, int seed, int checkpoint) const;
    nlohmann::ordered_json LoadOwn(const std::string &path) const;
    std::string folder_, campaign_;
};

/// Writes text into a file with WriteFile.
void WriteText(const std::string &path, const std::string &text);

}  // namespace pbrt::lab
