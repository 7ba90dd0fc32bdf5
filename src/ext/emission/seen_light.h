#pragma once
#include <vector>

#include "pbrt/lightsamplers/group_light_sampler.h"

namespace ext {
using namespace pbrt;

/// What a prepass found of the light of one group in the picture.
struct SeenLight {
    /// Of the radiance that camera paths brought from the group by way of a vertex that is not specular, divided by the
    /// square of how bright the picture is there: 0.1 and the mean of a tile of 16 x 16 pixels over that of the
    /// picture.
    double sum = 0;
    int count = 0;  ///< of the light samples and light hits that brought any
};

/// Follows about `paths` camera paths, spread over the pixels that will be rendered, and adds up for every group of
/// `chooser` what they find of its light, by light sampling with `chooser` and by BSDF sampling, combined by the
/// power heuristic. No single find counts more than a hundred times their mean. Light that the camera sees directly, or
/// in mirrors and through glass, does not count: no light path brings it. Depends on the seed only, not on threads. One
/// Progress phase.
std::vector<SeenLight> FindSeenLight(PrepareContext &context, const GroupLightSampler &chooser, double paths);

}  // namespace ext
