#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "pbrt/lab/sampler_choice.h"
#include "pbrt/math/bounds.h"

namespace pbrt::lab {

/// Everything that `lightlab scene.pbrt` was asked for.
struct CampaignSettings {
    std::string scene;
    std::vector<SamplerChoice> samplers;
    double timeBudget = 0;  ///< > 0: seconds of every run, preparation included; else samplesPerPixel of every run
    int samplesPerPixel = 64;
    int seeds = 3;
    std::optional<int> maxDepth;    ///< empty: the scene's
    bool sampledLightOnly = false;  ///< PathSettings::sampledLightOnly
    int resolutionDivisor = 1;
    std::string shadowGate;       ///< of samplers without a gate of their own; empty: the scene's
    std::string referenceFile;    ///< empty: one is rendered
    int referenceSamples = 0;     ///< 0: chosen from the budget, see ReferenceRule
    std::string samplesFrom;      ///< results.json whose sample counts are replayed instead of measuring time
    std::vector<Bounds2i> crops;  ///< empty: chosen where the samplers differ most
    bool views = true;            ///< a look inside every sampler, see campaign_views.h
    double selectionWork = 1e8;   ///< of the check of light selection, SelectionSettings::mostWork; 0: none
    std::string outFolder;
    std::string cacheFolder;  ///< where rendered references are kept for other campaigns; empty: nowhere
    bool restart = false;     ///< forget what the folder holds of a campaign
    std::string commandLine;
    bool Timed() const { return timeBudget > 0; }
};

/// What fixes the pictures and times of a campaign. Two campaigns in one folder must agree in all of it but the number
/// of seeds.
nlohmann::ordered_json IdentityOf(const CampaignSettings &settings, const std::string &sceneHash, int threads);
/// A hash of an identity without the number of seeds: what records say they belong to.
std::string CampaignKey(nlohmann::ordered_json identity);
/// The keys in which two identities differ, but for the number of seeds, with both values, for people; empty if none.
std::vector<std::string> Differences(const nlohmann::ordered_json &old, const nlohmann::ordered_json &now);

/// Sample counts of a finished campaign: what --samples-from replays.
class SampleCounts {
  public:
    /// Throws UserError if the file is no results.json of lightlab, or lacks a sampler or seed of `settings`.
    SampleCounts(const std::string &path, const CampaignSettings &settings);
    int Checkpoints() const { return checkpoints_; }
    /// Samples of a run at a checkpoint.
    int At(const std::string &label, int seed, int checkpoint) const;
    /// What the preparation of a sampler's runs was told to expect.
    int Expected(const std::string &label) const { return expected_.at(label); }
    const std::string &Hash() const { return hash_; }

  private:
    std::map<std::pair<std::string, int>, std::vector<int>> counts_;
    std::map<std::string, int> expected_;
    int checkpoints_ = 0;
    std::string hash_;
};

/// "schema" of results.json; docs/lightlab.md describes it.
inline constexpr int kResultsSchema = 2;
/// The part of a results.json that a replay takes its settings from. Throws UserError.
nlohmann::ordered_json ReadResults(const std::string &path);

}  // namespace pbrt::lab
