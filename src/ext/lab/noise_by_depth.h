#pragma once
#include <span>
#include <vector>

#include "ext/lab/experiment_settings.h"
#include "pbrt/core/progress.h"
#include "pbrt/images/image.h"

namespace ext::lab {

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
