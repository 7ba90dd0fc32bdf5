#pragma once
#include <functional>

#include "pbrt/spectra/color_space.h"

namespace pbrt::test {

/// Skies for tests of their parts.
struct Sky {
    const char *name;
    std::function<Rgb(int, int)> color;  ///< by pixel; empty: one colour, without an image
    int resolution = 0;
};
inline const Sky kSkies[] = {
    {"one_colour", nullptr, 0},
    {"gradient", [](int x, int y) { return Rgb(0.1f * Float(x + 1), 0.4f, 0.05f * Float(y)); }, 12},
    {"one_bright_pixel", [](int x, int y) { return x == 5 && y == 8 ? Rgb(800) : Rgb(0.1f); }, 16},
    {"half_black", [](int, int y) { return Rgb(y < 8 ? 0.f : 1.f); }, 16}};

}  // namespace pbrt::test
