#pragma once
#include <vector>

#include "pbrt/lightsamplers/group_light_sampler.h"

namespace ext {
using namespace pbrt;

struct ImageContribution {
    /// Sum of the contributions of camera paths with a non-specular vertex, over the squared relative brightness: 0.1
    /// plus the mean of a 16 x 16 pixel tile over the image mean.
    double sum = 0;
    int count = 0;  ///< number of non-zero contributions
};

/// Traces about `paths` camera paths, spread over the rendered pixels, and sums the contributions of every group of
/// `chooser`. Light sampling (with `chooser`) and BSDF sampling are combined by the power heuristic. Contributions are
/// clamped to a hundred times their mean. Directly visible or purely specular light is excluded, as no light path
/// carries it. Depends on the seed only, not on threads. One Progress phase.
std::vector<ImageContribution> EstimateImageContributions(PrepareContext &context, const GroupLightSampler &chooser,
                                                          double paths);

}  // namespace ext
