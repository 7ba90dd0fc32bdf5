#pragma once
#include <map>
#include <optional>

#include "ext/lab/sampler_choice.h"
#include "ext/lab/text_output.h"
#include "pbrt/math/bounds.h"

namespace ext::lab {

/// The settings of `lightlab scene.pbrt`.
struct ExperimentSettings {
    std::string scene;
    std::vector<SamplerChoice> samplers;
    double timeBudget = 0;  ///< seconds of every run, preparation included; 0: every run takes samplesPerPixel
    int samplesPerPixel = 64;
    int seeds = 3;
    std::optional<int> maxDepth;    ///< empty: the scene's
    bool sampledLightOnly = false;  ///< PathSettings::sampledLightOnly
    int resolutionDivisor = 1;
    std::string referenceFile;    ///< empty: one is rendered
    int referenceSamples = 0;     ///< 0: chosen from the budget, see ReferenceRule
    std::string samplesFrom;      ///< results.json whose sample counts are replayed instead of measuring time
    std::vector<Bounds2i> crops;  ///< empty: chosen where the samplers differ most
    bool views = true;            ///< write inspection views of every sampler, see WriteViews
    double selectionWork = 1e8;   ///< SelectionSettings::mostWork of the light-selection check; 0: no check
    std::string outFolder;
    std::string cacheFolder;  ///< where rendered references are kept for other experiments; empty: nowhere
    bool restart = false;     ///< delete the records of an experiment in outFolder first
    std::string commandLine;
    bool Timed() const { return timeBudget > 0; }
};

/// Returns all settings that the pictures and times of an experiment depend on. Experiments that share a folder must
/// agree in everything but the number of seeds.
Json IdentityOf(const ExperimentSettings &settings, const std::string &sceneHash, int threads);
/// Returns a hash of an identity without the number of seeds, by which records name their experiment.
std::string ExperimentKey(Json identity);
/// Returns the keys, other than the number of seeds, in which two identities differ, with both values as text for the
/// user; empty if there are none.
std::vector<std::string> Differences(const Json &old, const Json &now);

/// The sample counts of a finished experiment, which --samples-from replays.
class SampleCounts {
  public:
    /// Throws UserError if the file is no results.json of lightlab, or lacks a sampler or seed of `settings`.
    SampleCounts(const std::string &path, const ExperimentSettings &settings);
    int Checkpoints() const { return checkpoints_; }
    /// Samples of a run at a checkpoint.
    int At(const std::string &label, int seed, int checkpoint) const;
    /// Samples per pixel that the preparation of a sampler's runs expects.
    int Expected(const std::string &label) const { return expected_.at(label); }
    const std::string &Hash() const { return hash_; }

  private:
    std::map<std::pair<std::string, int>, std::vector<int>> counts_;
    std::map<std::string, int> expected_;
    int checkpoints_ = 0;
    std::string hash_;
};

/// "schema" of results.json; docs/guide/lightlab.md describes it.
inline constexpr int kResultsSchema = 2;
/// Reads a results.json from which a replay takes settings and sample counts. Throws UserError.
Json ReadResults(const std::string &path);

}  // namespace ext::lab
