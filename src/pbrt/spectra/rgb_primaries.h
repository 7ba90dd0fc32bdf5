#pragma once
#include <array>
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

// Layout of the fitted tables: float coefficients (c0, c1, c2) at [slab][scale][y][x]. slab: index m of the largest
// component; scale: node of its value; x, y: components m+1 and m+2 (mod 3) relative to it, on equally spaced nodes of
// [0, 1].

inline constexpr size_t RgbTableResolution = 64;
inline constexpr size_t RgbTableFloats = 3 * 3 * RgbTableResolution * RgbTableResolution * RgbTableResolution;

constexpr size_t RgbTableIndex(size_t slab, size_t scale, size_t y, size_t x) {
    return 3 * (((slab * RgbTableResolution + scale) * RgbTableResolution + y) * RgbTableResolution + x);
}

/// Values of the largest component at the scale nodes, dense towards 0 and 1, where the coefficients change fastest.
constexpr std::array<Float, RgbTableResolution> RgbTableScales() {
    auto smoothStep = [](double t) { return t * t * (3 - 2 * t); };
    std::array<Float, RgbTableResolution> nodes{};
    for (size_t k = 0; k < RgbTableResolution; ++k)
        nodes[k] = Float(smoothStep(smoothStep(double(k) / double(RgbTableResolution - 1))));
    return nodes;
}

}  // namespace pbrt
