#pragma once
#include <vector>

#include "pbrt/lightsamplers/group_light_sampler.h"

namespace ext {
using namespace pbrt;

/// Contribution of the lights of one group to the picture.
struct ImageContribution {
    /// Sum of the contributions of camera paths by way of a vertex that is not specular, over the square of the
    /// relative brightness there: 0.1 plus the mean of a tile of 16 x 16 pixels over that of the picture.
    double sum = 0;
    int count = 0;  ///< of contributions that are not 0
};

/// Follows about `paths` camera paths, spread over the pixels that will be rendered, and sums up the contributions of
/// every group of `chooser`, by light sampling with `chooser` and by BSDF sampling, combined by the power heuristic. No
/// contribution counts more than a hundred times their mean. Light seen directly or through specular vertices only does
/// not count, as no light path brings it. Depends on the seed only, not on threads. One Progress phase.
std::vector<ImageContribution> EstimateImageContributions(PrepareContext &context, const GroupLightSampler &chooser,
                                                          double paths);

}  // namespace ext
