#pragma once
#include <map>
#include <optional>

#include "ext/lab/sampler_choice.h"
#include "ext/lab/text_output.h"
#include "pbrt/math/bounds.h"

namespace ext::lab {

struct ExperimentSettings {
    std::string scene;
    std::vector<SamplerChoice> samplers;
    double timeBudget = 0;  ///< seconds per run, including preparation; 0: every run takes samplesPerPixel
    int samplesPerPixel = 64;
    int seeds = 3;
    std::optional<int> maxDepth;    ///< empty: the scene's
    bool sampledLightOnly = false;  ///< PathSettings::sampledLightOnly
    int resolutionDivisor = 1;
    std::string referenceFile;    ///< empty: rendered
    int referenceSamples = 0;     ///< 0: from the budget, see ReferenceRule
    std::string samplesFrom;      ///< results.json whose sample counts are replayed instead of measuring time
    std::vector<Bounds2i> crops;  ///< empty: where the samplers differ most
    bool views = true;            ///< write inspection views per sampler, see WriteViews
    double selectionWork = 1e8;   ///< SelectionSettings::mostWork of the light selection check; 0: no check
    std::string outFolder;
    std::string cacheFolder;  ///< shared cache of rendered references; empty: none
    bool restart = false;     ///< delete the records of an experiment in outFolder first
    std::string commandLine;
    bool Timed() const { return timeBudget > 0; }
};

/// All settings that images and times of an experiment depend on. Experiments that share a folder must agree in all but
/// the number of seeds.
Json IdentityOf(const ExperimentSettings &settings, const std::string &sceneHash, int threads);
/// Hash of an identity without the number of seeds, by which records identify their experiment.
std::string ExperimentKey(Json identity);
/// Keys, other than the number of seeds, in which two identities differ, with both values as text; empty if none.
std::vector<std::string> Differences(const Json &old, const Json &now);

/// Sample counts of a finished experiment, replayed by --samples-from.
class SampleCounts {
  public:
    /// Throws UserError if the file is not lightlab's results.json, or lacks a sampler or seed of `settings`.
    SampleCounts(const std::string &path, const ExperimentSettings &settings);
    int Checkpoints() const { return checkpoints_; }
    int At(const std::string &label, int seed, int checkpoint) const;
    /// Samples per pixel expected by the preparation of a sampler's runs.
    int Expected(const std::string &label) const { return expected_.at(label); }
    const std::string &Hash() const { return hash_; }

  private:
    std::map<std::pair<std::string, int>, std::vector<int>> counts_;
    std::map<std::string, int> expected_;
    int checkpoints_ = 0;
    std::string hash_;
};

/// "schema" of results.json, documented in docs/guide/lightlab.md.
inline constexpr int kResultsSchema = 2;
/// Reads a results.json to be replayed. Throws UserError.
Json ReadResults(const std::string &path);

}  // namespace ext::lab
