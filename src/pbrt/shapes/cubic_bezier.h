#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "pbrt/math/vec.h"

namespace pbrt {

struct CubicBezier {
    std::array<Point3, 4> p{};

    Point3 At(Float u) const { return Blossom(u, u, u); }
    Vector3 Derivative(Float u) const {
        Vector3 a = Lerp(u, p[1] - p[0], p[2] - p[1]), b = Lerp(u, p[2] - p[1], p[3] - p[2]);
        return Float(3) * Lerp(u, a, b);
    }
    CubicBezier Part(Float u0, Float u1) const {
        return {{Blossom(u0, u0, u0), Blossom(u0, u0, u1), Blossom(u0, u1, u1), Blossom(u1, u1, u1)}};
    }
    void Halves(CubicBezier *first, CubicBezier *second) const {
        constexpr Float kHalf = 0.5f;
        Point3 p01 = (p[0] + p[1]) * kHalf, p12 = (p[1] + p[2]) * kHalf, p23 = (p[2] + p[3]) * kHalf;
        Point3 p012 = (p01 + p12) * kHalf, p123 = (p12 + p23) * kHalf;
        Point3 middle = (p012 + p123) * kHalf;
        *first = {{p[0], p01, p012, middle}};
        *second = {{middle, p123, p23, p[3]}};
    }
    /// Multi-affine form: B(u, u, u) is the point at u.
    Point3 Blossom(Float a, Float b, Float c) const {
        Point3 p01 = Lerp(a, p[0], p[1]), p12 = Lerp(a, p[1], p[2]), p23 = Lerp(a, p[2], p[3]);
        return Lerp(c, Lerp(b, p01, p12), Lerp(b, p12, p23));
    }
    /// Largest component of the second differences; 6 times it bounds the second derivative.
    Float LargestSecondDifference() const {
        return std::max(MaxComponent(Abs(p[0] - Float(2) * p[1] + p[2])),
                        MaxComponent(Abs(p[1] - Float(2) * p[2] + p[3])));
    }
};

enum class CurveBasis { Bezier, BSpline };

/// Number of segments for `count` control points; 0 if the count is invalid.
size_t SegmentCount(size_t count, int degree, CurveBasis basis);
/// Segment `index` as a cubic. Degree 2 or 3; B-splines are uniform.
CubicBezier SegmentOf(std::span<const Point3> points, size_t index, int degree, CurveBasis basis);

}  // namespace pbrt
