#pragma once
#include <optional>
#include <span>
#include <string>

#include "ext/lab/experiment_settings.h"
#include "ext/lab/reference.h"
#include "ext/lab/text_output.h"
#include "pbrt/core/progress.h"

namespace ext::lab {

struct ExperimentOutcome {
    Json results;      ///< contents of results.json
    std::string text;  ///< table and conclusion, for the terminal
};

/// Compares light samplers on one scene. Builds it once, creates the reference, and renders every (sampler, seed) in
/// rounds A B C A B C ..., measuring after each. Writes results, images and tables into the output folder. Resumes an
/// interrupted experiment of equal settings from the records in the folder. Returns nothing if cancelled; finished
/// rounds remain. Throws UserError, for errors in the settings before rendering. `display` may be null.
std::optional<ExperimentOutcome> RunExperiment(const ExperimentSettings &settings, const PluginRegistry &registry,
                                               Progress &cancel, ProgressSink *display);

/// Measurement points of a run. With a time budget: after one sample, then at budget / 64, / 32, ..., / 1 of the run's
/// own clock. Else after 1, 2, 4, ... and all samples.
std::vector<RenderTarget> Checkpoints(const ExperimentSettings &settings);

/// Writes inspection views of a sampler at the first visible surfaces, as <sampler>/views/*.png; for sampler 0 also the
/// sampler-independent ones, as views/*.png. Takes some seconds. Records what was written. Returns false if cancelled.
bool WriteViews(const ExperimentContext &context, size_t sampler, const Integrator &integrator);
/// True if all recorded images of the sampler exist with their file sizes.
bool HasViews(const ExperimentContext &context, size_t sampler);
/// Adds "views" to results.json, for the scene and every sampler with views.
void AddViews(const ExperimentContext &context, Json *results);

/// Exposure factor before the PNG's sRGB curve, which clips at 1, from the reference's luminances. Maps the median of
/// the non-black pixels to mid grey, 0.18, so that interiors are visible, but keeps three quarters of these pixels
/// below 0.9. Never below the factor that maps the 98th percentile to 0.9. Shared by all images of an experiment.
double ChooseExposure(const Image &reference);
/// Writes R, G, B with full range as a Radiance file: shared exponent, 8 bits per colour, no run-length coding.
void WriteRangeImage(const std::string &path, const Image &image);

/// Writes references, results and errors as images, and adds them and the crops to `json`.
void WritePictures(const ExperimentContext &context, const References &references,
                   const std::vector<std::vector<Image>> &pictures, Json *json);

/// Noise of at least two images of a scene: variance per pixel and channel over (r^2 + RelL2Epsilon), averaged over the
/// image; the expected relL2 of one of them. `r`: reference image.
struct Noise {
    double plain = 0;
    double trimmed = 0;  ///< excluding the noisiest 0.1 % of pixels
};
Noise NoiseOf(std::span<const Image> pictures, const Image &reference);

/// 1, 2, 3, 4, 6, 8, 12, ... scattering events, up to `maxDepth`.
std::vector<int> NoiseDepths(int maxDepth);

/// Renders the scene with every sampler and seed, with path depths limited to 1, 2, 3, ... scattering events, and
/// reports the noise added per depth. The sampler `oracle`, whose probabilities minimize variance, gives the lower
/// bound of any light selection.
///
/// Used of `settings`: scene, samplers, samples per pixel, seeds (at least 2), divisor, maxDepth, folder, command line.
/// Writes noise.json and index.html into the folder and prints a table. Exit status: 0, or 130 if interrupted. Throws
/// UserError.
int RunNoise(const ExperimentSettings &settings, const PluginRegistry &registry, Progress &progress);

}  // namespace ext::lab
