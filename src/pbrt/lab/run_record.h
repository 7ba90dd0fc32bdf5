#pragma once
#include <limits>
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
/// that is not finished. All but the settings name the campaign they belong to; what names another one, another version
/// of this program, or cannot be read, is as good as absent.
class RecordFolder {
  public:
    /// `campaign`: CampaignKey of the settings.
    RecordFolder(std::string folder, std::string campaign)
        : folder_(std::move(folder)), campaign_(std::move(campaign)) {}
    const std::string &Folder() const { return folder_; }
    /// The rounds of a run from the first on without a gap, at most so many.
    RunRecord LoadRun(const std::string &sampler, int seed, int most = std::numeric_limits<int>::max()) const;
    void SaveLastRound(const std::string &sampler, const RunRecord &run) const;
    std::string FilmFile(const std::string &sampler, int seed, int checkpoint) const;
    /// One more than the last round that has a file, whatever is in it.
    size_t CountRounds(const std::string &sampler, int seed, size_t checkpoints) const;
    /// Files of the rounds from `kept` on, and all films but that of the round before.
    void RemoveRounds(const std::string &sampler, int seed, size_t kept, size_t checkpoints) const;

    /// The settings of the campaign that the folder holds, whichever it is: null if there is none, discarded if
    /// unreadable.
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

/// Text into a file, as WriteFile does it.
void WriteText(const std::string &path, const std::string &text);

}  // namespace pbrt::lab
