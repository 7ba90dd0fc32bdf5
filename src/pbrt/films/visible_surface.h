#pragma once

#include "pbrt/math/vec.h"
#include "pbrt/spectra/color_space.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// First scattering surface along a camera ray, in rendering space.
struct VisibleSurface {
    Point3 p{};
    Normal3 n{}, ns{};  ///< unit, geometric and shading, facing the camera
    Point2 uv{};
    Vector3 dpdx{}, dpdy{};  ///< derivatives of p over the filter footprint
    Float time = 0;          ///< of the ray
    SampledSpectrum albedo;  ///< at `lambda`
    SampledWavelengths lambda;
};

/// Colour of the space's white after one reflection at the surface.
Rgb AlbedoColor(const VisibleSurface &visible, const ColorSpace &space);

/// Mean normals of pixels without a surface are zero.
inline glm::dvec3 UnitOrZero(const glm::dvec3 &v) { return glm::dot(v, v) > 0 ? glm::normalize(v) : glm::dvec3(0); }

}  // namespace pbrt
