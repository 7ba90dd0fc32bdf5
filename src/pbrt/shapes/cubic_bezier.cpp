#include "pbrt/shapes/cubic_bezier.h"

#include "pbrt/core/error.h"

namespace pbrt {

size_t SegmentCount(size_t count, int degree, CurveBasis basis) {
    PBRT_CHECK(degree == 2 || degree == 3);
    auto d = static_cast<size_t>(degree);
    if (count < d + 1) return 0;
    if (basis == CurveBasis::BSpline) return count - d;
    return (count - 1) % d == 0 ? (count - 1) / d : 0;
}

CubicBezier SegmentOf(std::span<const Point3> points, size_t index, int degree, CurveBasis basis) {
    if (degree == 3) {
        if (basis == CurveBasis::Bezier) {
            const Point3 *p = &points[3 * index];
            return {{p[0], p[1], p[2], p[3]}};
        }
        // Blossoms of the spline with knots -2..3 about the segment [0, 1]: b(0,0,0), b(0,0,1), b(0,1,1), b(1,1,1).
        const Point3 *p = &points[index];
        constexpr Float kThird = Float(1) / 3;
        Point3 b01 = Lerp(kThird, p[1], p[2]), b10 = Lerp(kThird, p[2], p[1]);
        return {
            {(Lerp(kThird, p[1], p[0]) + b01) * Float(0.5), b01, b10, (b10 + Lerp(kThird, p[2], p[3])) * Float(0.5)}};
    }
    const Point3 *p = &points[basis == CurveBasis::Bezier ? 2 * index : index];
    Point3 a = p[0], b = p[1], c = p[2];
    if (basis == CurveBasis::BSpline) {
        a = (a + b) * Float(0.5);
        c = (b + c) * Float(0.5);
    }
    constexpr Float kTwoThirds = Float(2) / 3;
    return {{a, Lerp(kTwoThirds, a, b), Lerp(kTwoThirds, c, b), c}};
}

}  // namespace pbrt
