#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ext/lab/text_output.h"
#include "pbrt/build/built_scene.h"

namespace ext::lab {
using namespace pbrt;

inline constexpr const char *kSamplersFlag = "--samplers";  ///< flag named in messages about a choice

/// A compared sampler: kLightChoiceSyntax.
struct SamplerChoice {
    std::string label;   ///< as typed
    std::string folder;  ///< the label as a safe file name
    std::string name;    ///< of the light sampler
    bool meshLights = false;
    LightSamplerTraits traits{};
};

/// Splits a list of samplers. A semicolon ends a sampler, and so does a comma unless a "key=value" follows, which
/// belongs to the preceding sampler: "octree:budget=0.02,floor=0.2,bvh" is two samplers.
std::vector<std::string> SplitSamplerList(const std::string &text);
/// Reads one sampler per line, ignoring blank lines and text after #. Throws UserError if unreadable or without
/// sampler.
std::vector<std::string> ReadSamplerFile(const std::string &path);

/// Throws one UserError with all unknown names and parameters, invalid values and duplicates.
std::vector<SamplerChoice> ParseSamplerChoices(const std::vector<std::string> &texts, const PluginRegistry &registry);

/// Replaces all characters except letters, digits and `kept` by _.
std::string SafeFileName(std::string text, std::string_view kept = "-+=.,");

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
    double selectionWork = 1e8;   ///< SelectionSettings::maxWork of the light selection check; 0: no check
    std::string outFolder;
    std::string cacheFolder;  ///< shared cache of rendered references; empty: none
    bool restart = false;     ///< delete the records of an experiment in outFolder first
    std::string commandLine;
    bool Timed() const { return timeBudget > 0; }
};

/// All settings that images and times of an experiment depend on. In one folder, only the number of seeds may differ.
Json IdentityOf(const ExperimentSettings &settings, const std::string &sceneHash, int threads);
/// Hash of an identity without the number of seeds, by which records identify their experiment.
std::string ExperimentKey(Json identity);
/// Keys, other than the number of seeds, in which two identities differ, with both values as text; empty if none.
std::vector<std::string> Differences(const Json &old, const Json &now);

/// Sample counts of a finished experiment, replayed by --samples-from.
struct SampleCounts {
    std::map<std::pair<std::string, int>, std::vector<int>> runs;  ///< by label and seed: per pixel, at each checkpoint
    std::map<std::string, int> expected;  ///< by label: samples per pixel expected by the preparation
    int checkpoints = 0;
    std::string hash;
    /// Throws UserError if the file is not lightlab's results.json, or lacks a sampler or seed of `settings`.
    static SampleCounts Read(const std::string &path, const ExperimentSettings &settings);
};

inline constexpr int kResultsSchema = 2;  ///< "schema" of results.json, documented in docs/guide/lightlab.md
/// Reads a results.json to be replayed. Throws UserError.
Json ReadResults(const std::string &path);

struct LabScene {
    BuiltScene built;
    std::string hash;  ///< SceneHash of its files
    Point2i FullResolution() const { return built.film->FullResolution(); }
    const Bounds2i &Pixels() const { return built.film->PixelBounds(); }
    Point2i Resolution() const { return Pixels().high - Pixels().low; }
    /// Samples per pixel of one sampler batch; longer renders add batches with other seeds. Texture filters depend on
    /// it, so it is equal for all runs and references.
    int Batch() const { return built.samplesPerPixel; }
    /// Metadata of the film, and attributes that name scene, program and the other arguments. `samples`: per pixel.
    ImageMetadata Metadata(const Film &film, const std::string &sampler, int samples, double seconds) const;
    std::unique_ptr<Integrator> MakeIntegrator(const SamplerChoice &choice, std::optional<int> maxDepth = {}) const;
};

/// Builds a parsed scene and logs the warnings of the sink. Throws UserError, also if the integrator has no light
/// sampler or the scene no lights. `file`: for messages.
BuiltScene BuildLitScene(SceneDescription &description, const std::string &file, const BuildOptions &options,
                         const PluginRegistry &registry, DiagnosticSink &sink, Progress &progress);

/// Throws UserError, as BuildLitScene.
LabScene LoadLabScene(const ExperimentSettings &settings, const PluginRegistry &registry, Progress &progress);

}  // namespace ext::lab
