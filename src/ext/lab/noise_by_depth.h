#pragma once
#include <string>
#include <vector>

#include "ext/lab/experiment_settings.h"
#include "ext/lab/text_output.h"
#include "pbrt/core/progress.h"
#include "pbrt/images/image.h"

namespace ext::lab {

/// The options of `lightlab noise scene.pbrt`.
struct NoiseOptions {
    ExperimentSettings experiment;  ///< scene, samples per pixel, seeds (at least 2), divisor, maxDepth, folder
    std::vector<std::string> samplers;
};

/// The noise of pictures of one scene: their variance per pixel and channel over (r^2 + RelL2Epsilon), mean over the
/// picture; the relL2 that one of them is expected to have. `r`: what it is measured against. There are at least two
/// pictures.
struct Noise {
    double plain = 0;
    double trimmed = 0;  ///< without the 0.1 % of the pixels that have most
};
Noise NoiseOf(const std::vector<Image> &pictures, const Image &reference);

/// 1, 2, 3, 4, 6, 8, 12, ... scattering events, up to `maxDepth`.
std::vector<int> NoiseDepths(int maxDepth);

/// Renders the scene with every sampler and seed, with paths of at most 1, 2, 3, ... scattering events, and reports how
/// much noise each vertex adds: where a sampler or a guide can still gain. With the sampler `oracle`, which chooses
/// lights with the least variance that any probabilities have, it is the bound that is left if the choice of lights is
/// perfect at every vertex.
///
/// Writes noise.json and index.html into the folder and prints a table. Exit status: 0, or 130 if interrupted. Throws
/// UserError.
int RunNoise(const NoiseOptions &options, const PluginRegistry &registry, Progress &progress);

}  // namespace ext::lab
