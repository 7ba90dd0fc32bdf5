#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pbrt/core/float.h"

namespace pbrt {

/// A line of a lens file, in metres. Elements are listed from scene to film.
struct LensElement {
    Float curvatureRadius = 0;  ///< above 0: convex towards the scene; 0: an aperture stop
    Float thickness = 0;        ///< distance to the next element or the film
    Float index = 1;            ///< refractive index between this element and the next
    Float apertureRadius = 0;
    bool IsStop() const { return curvatureRadius == 0; }
};

/// Reads a lens file (pbrt-v4-format §15). Throws UserError (no location).
std::vector<LensElement> ReadLensFile(const std::string &path);

/// Paraxial optics of a lens in air, metres.
struct CardinalPoints {
    double focalLength = 0;     ///< infinite or NaN for an afocal lens
    double rearPrincipal = 0;   ///< from the last element's vertex towards the scene
    double frontPrincipal = 0;  ///< from the first element's vertex towards the film
};
CardinalPoints ComputeCardinalPoints(std::span<const LensElement> elements);

/// Distance from the last element to the film that focuses the plane at `distance` from the film, for small angles.
/// Empty if there is none.
std::optional<double> FocusedThickness(std::span<const LensElement> elements, double distance);

}  // namespace pbrt
