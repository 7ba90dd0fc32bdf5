#pragma once
#include "pbrt/films/gbuffer_film.h"
#include "pbrt/integrators/integrator.h"

namespace pbrt {

/// The first surface along the ray that scatters, as a gbuffer film wants it: interface surfaces are looked through.
/// `outputFromRender`: into the film's coordinates.
std::optional<VisibleSurface> FindVisibleSurface(const PathContext &context, const Transform &outputFromRender,
                                                 const CameraRay &ray, const SampledWavelengths &lambda);

}  // namespace pbrt
