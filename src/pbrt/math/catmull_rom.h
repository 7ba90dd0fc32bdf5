#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <ranges>
#include <span>

#include "pbrt/math/vec.h"

namespace pbrt {

// Cubic Hermite splines through (node, value) pairs. The slope at a node is that of the chord between its neighbours;
// at the ends, of the outermost chord. At least four strictly increasing nodes.

/// Spline value at x: sum of w[k] * value[first + k].
struct SplineWeights {
    int first = 0;
    std::array<Float, 4> w{};
};
/// Empty if x is outside the nodes.
std::optional<SplineWeights> CatmullRomWeights(std::span<const Float> nodes, Float x);

/// One segment as a polynomial in t in [0, 1]; slopes are by t.
struct SplinePiece {
    Float x = 0, width = 0;
    Float c0 = 0, c1 = 0, c2 = 0, c3 = 0;

    SplinePiece(Float x, Float width, Float f0, Float f1, Float slope0, Float slope1)
        : x(x), width(width), c0(f0), c1(slope0), c2(3 * (f1 - f0) - 2 * slope0 - slope1),
          c3(2 * (f0 - f1) + slope0 + slope1) {}
    Float Value(Float t) const { return c0 + t * (c1 + t * (c2 + t * c3)); }
    Float Slope(Float t) const { return c1 + t * (2 * c2 + t * 3 * c3); }
    Float Integral(Float t) const { return width * t * (c0 + t * (c1 / 2 + t * (c2 / 3 + t * (c3 / 4)))); }
};

/// Segment between nodes i and i + 1 of the spline through value(k).
SplinePiece CatmullRomPiece(std::span<const Float> nodes, int i, auto value) {
    const int last = int(nodes.size()) - 1;
    const Float width = nodes[i + 1] - nodes[i], f0 = value(i), f1 = value(i + 1);
    const Float slope0 = i > 0 ? width * (f1 - value(i - 1)) / (nodes[i + 1] - nodes[i - 1]) : f1 - f0;
    const Float slope1 = i + 2 <= last ? width * (value(i + 2) - f0) / (nodes[i + 2] - nodes[i]) : f1 - f0;
    return SplinePiece(nodes[i], width, f0, f1, slope0, slope1);
}

/// Solves f(t) = y for t in [0, 1], f increasing from f(0) <= y to f(1) >= y: Newton steps, else bisection.
Float SolveIncreasing(auto f, auto slope, Float y, Float tolerance) {
    Float low = 0, high = 1, t = Float(0.5);
    for (int i = 0; i < 64; ++i) {
        const Float difference = f(t) - y;
        if (std::abs(difference) <= tolerance || high - low < Float(1e-7)) break;
        (difference < 0 ? low : high) = t;
        const Float next = t - difference / slope(t);
        t = next > low && next < high ? next : (low + high) / 2;
    }
    return t;
}

/// Largest i in [0, count - 2] with at(i) <= y, else 0. `at` must not decrease.
int FindPiece(int count, auto at, Float y) {
    const auto inner = std::views::iota(1, count - 1);
    return *std::ranges::partition_point(inner, [&](int k) { return at(k) <= y; }) - 1;
}

/// Writes the running integral at the nodes to `cdf`; returns the total integral.
Float IntegrateCatmullRom(std::span<const Float> nodes, std::span<const Float> values, std::span<Float> cdf);

/// Inverts a spline with non-decreasing values at y. Returns the nearest end if y is out of range.
Float InvertCatmullRom(std::span<const Float> nodes, std::span<const Float> values, Float y);

/// Samples x proportionally to the spline through value(k) >= 0 with running integral cdf(k).
template <class Value, class Cdf>
Float SampleCatmullRom(std::span<const Float> nodes, Value value, Cdf cdf, Float u) {
    const int n = int(nodes.size());
    const Float whole = cdf(n - 1);
    if (!(whole > 0)) return nodes[0];
    const Float y = u * whole;
    const int i = FindPiece(n, cdf, y);
    const SplinePiece piece = CatmullRomPiece(nodes, i, value);
    const Float t =
        SolveIncreasing([&](Float s) { return piece.Integral(s); },
                        [&](Float s) { return piece.width * piece.Value(s); }, y - cdf(i), Float(1e-6) * whole);
    return piece.x + piece.width * t;
}

}  // namespace pbrt
