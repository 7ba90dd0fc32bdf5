#pragma once
#include <array>
#include <cstddef>

#include "pbrt/core/float.h"

namespace pbrt {

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
        nodes[k] = static_cast<Float>(smoothStep(smoothStep(double(k) / double(RgbTableResolution - 1))));
    return nodes;
}

}  // namespace pbrt
