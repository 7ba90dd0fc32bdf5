#pragma once
#include <bit>

#include "pbrt/math/bounds.h"

namespace pbrt {

/// A tile of a sky: a square of a quadtree over the equal-area square of the directions, so that all tiles of a level
/// have the same solid angle. Tiles are numbered breadth first: 0 is the whole sky, and n has the children 4n + 1 ...
/// 4n + 4, of which the lowest bit is x and the next one y.
struct SkyTile {
    static constexpr uint32_t kMaxLevel = 9;  ///< a tile of this level is 0.4 degrees wide
    static constexpr uint32_t FirstOf(uint32_t level) { return ((1u << 2 * level) - 1) / 3; }
    static constexpr uint32_t kCount = ((1u << 2 * (kMaxLevel + 1)) - 1) / 3;

    static constexpr uint32_t LevelOf(uint32_t number) {
        return static_cast<uint32_t>(std::bit_width(3 * number + 1) - 1) / 2;
    }

    uint32_t level = 0, x = 0, y = 0;  ///< x and y below 2^level

    static SkyTile Of(uint32_t number) {
        SkyTile tile;
        tile.level = LevelOf(number);
        const uint32_t place = number - FirstOf(tile.level);
        for (uint32_t bit = 0; bit < tile.level; ++bit) {
            tile.x |= (place >> 2 * bit & 1) << bit;
            tile.y |= (place >> (2 * bit + 1) & 1) << bit;
        }
        return tile;
    }
    uint32_t Number() const {
        uint32_t place = 0;
        for (uint32_t bit = 0; bit < level; ++bit) place |= (x >> bit & 1) << 2 * bit | (y >> bit & 1) << (2 * bit + 1);
        return FirstOf(level) + place;
    }
    /// The tile of a level that holds a point of [0, 1]^2.
    static SkyTile At(uint32_t level, const Point2 &st) {
        const auto n = static_cast<Float>(1u << level);
        auto index = [&](Float v) { return static_cast<uint32_t>(std::clamp(v * n, Float(0), n - 1)); };
        return {level, index(st.x), index(st.y)};
    }
    Bounds2 Square() const {
        const Float side = 1 / static_cast<Float>(1u << level);
        const Point2 low(static_cast<Float>(x) * side, static_cast<Float>(y) * side);
        return {low, low + Vector2(side)};
    }
};

}  // namespace pbrt
