#pragma once
#include <span>
#include <string>

#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// Definition of an RGB colour space (pbrt-v4-format §4): chromaticities of the primaries and an illuminant of §16.
struct RgbPrimaries {
    std::string name;
    Point2 r, g, b;
    std::string illuminant;
};

std::span<const RgbPrimaries> KnownRgbPrimaries();

Point2 Chromaticity(const Vector3 &xyz);
/// Colour of that chromaticity with Y = 1 (0 if y is 0).
Vector3 XyzFromChromaticity(const Point2 &xy);

/// Matrix that maps (1, 1, 1) to `white` and each unit vector to a multiple of its primary.
glm::mat3 ComputeXyzFromRgb(const Point2 &r, const Point2 &g, const Point2 &b, const Vector3 &white);

}  // namespace pbrt
