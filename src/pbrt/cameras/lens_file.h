#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pbrt/core/float.h"

namespace pbrt {

/// One line of a lens file, in metres. Elements are listed from the scene to the film.
struct LensElement {
    Float curvatureRadius = 0;  ///< above 0: convex towards the scene; 0: an aperture stop
    Float thickness = 0;        ///< distance to the next element, of the last one to the film
    Float index = 1;            ///< of refraction, between this element and the next
    Float apertureRadius = 0;
    bool IsStop() const { return curvatureRadius == 0; }
};

/// Reads a lens file (pbrt-v4-format §15). Throws UserError (no location).
std::vector<LensElement> ReadLensFile(const std::string &path);

/// Paraxial optics of a lens with air on both sides, metres.
struct CardinalPoints {
    double focalLength = 0;     ///< infinite or NaN if the lens does not bend light
    double rearPrincipal = 0;   ///< from the last element's vertex towards the scene
    double frontPrincipal = 0;  ///< from the first element's vertex towards the film
};
CardinalPoints ComputeCardinalPoints(std::span<const LensElement> elements);

/// The distance from the last element to the film that makes the plane `distance` in front of the film sharp, for small
/// angles. Empty if no position does.
std::optional<double> FocusedThickness(std::span<const LensElement> elements, double distance);

}  // namespace pbrt
