#include "pbrt/shapes/solid_angle_sampling.h"

#include <gtest/gtest.h>

#include "pbrt/math/rng.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

TEST(SphericalTriangle, KnownAreas) {
    EXPECT_NEAR(SphericalTriangle({1, 0, 0}, {0, 1, 0}, {0, 0, 1}).Area(), Pi / 2, 1e-6);
    const Float s = 1e-3f;  // so small that it is flat
    EXPECT_NEAR(SphericalTriangle({0, 0, 1}, Normalize({s, 0, 1}), Normalize({0, s, 1})).Area() / (s * s / 2), 1, 1e-3);
}

TEST(SphericalTriangle, InvertUndoesSample) {
    Rng rng(1);
    for (int i = 0; i < 2000; ++i) {
        Float size = std::pow(Float(10), -2 * rng.Uniform());  // from 1 down to 0.01 across
        Vector3 axis = Normalize(Vector3(rng.Uniform() - 0.5f, rng.Uniform() - 0.5f, 0.7f)), v[3];
        for (Vector3 &x : v)
            x = Normalize(axis + size * Vector3(rng.Uniform() - 0.5f, rng.Uniform() - 0.5f, rng.Uniform() - 0.5f));
        const SphericalTriangle triangle(v[0], v[1], v[2]);
        if (triangle.Area() < 0.05f * size * size) continue;  // slivers lose digits in any method
        Point2 u = Point2(0.02f) + Float(0.96) * rng.Uniform2();
        const Vector3 weights = triangle.Sample(u);
        EXPECT_NEAR(Length(triangle.Direction(weights)), 1, 1e-6);
        Point2 back = triangle.Invert(Float(0.3) * weights, Normalize(triangle.Direction(weights)));
        EXPECT_NEAR(back.x, u.x, 2e-2) << size;
        EXPECT_NEAR(back.y, u.y, 2e-2) << size;
    }
}

TEST(SphericalTriangle, ShareOfAreaIsShareOfSamples) {
    // A sub-triangle that shares only corner a must get its share of uniform samples.
    Vector3 a(1, 0, 0), b(0, 1, 0), c = Normalize({0.2f, 0.1f, 1});
    Vector3 mid1 = Normalize(a + b), mid2 = Normalize(a + c);
    const SphericalTriangle triangle(a, b, c);
    const Float part = SphericalTriangle(a, mid1, mid2).Area();
    Vector3 cut = Cross(mid1, mid2);
    if (Dot(cut, a) < 0) cut = -cut;
    Rng rng(2);
    constexpr int kSamples = 200000;
    int inside = 0;
    for (int i = 0; i < kSamples; ++i) inside += Dot(triangle.Direction(triangle.Sample(rng.Uniform2())), cut) > 0;
    double p = double(part) / double(triangle.Area()), z = (inside - kSamples * p) / std::sqrt(kSamples * p * (1 - p));
    EXPECT_GT(NormalTail(z), 1e-4);
}

TEST(SphericalRectangle, SolidAngleIsThatOfTwoTriangles) {
    Rng rng(3);
    for (int i = 0; i < 1000; ++i) {
        Point3 corner(rng.Uniform() - 0.5f, rng.Uniform() - 0.5f, 0.2f + rng.Uniform());
        Vector3 x(0.1f + rng.Uniform(), 0, 0), y(0, 0.1f + rng.Uniform(), 0);
        Point3 eye(rng.Uniform() - 0.5f, rng.Uniform() - 0.5f, 0);
        auto to = [&](const Point3 &p) { return Normalize(p - eye); };
        Float triangles = SphericalTriangle(to(corner), to(corner + x), to(corner + x + y)).Area() +
                          SphericalTriangle(to(corner), to(corner + x + y), to(corner + y)).Area();
        EXPECT_NEAR(SphericalRectangle(eye, corner, x, y).SolidAngle(), triangles, 2e-6 + 1e-5 * double(triangles));
    }
}

TEST(SphericalRectangle, InvertUndoesSample) {
    Rng rng(4);
    for (int i = 0; i < 2000; ++i) {
        Float far = std::pow(Float(10), 2 * rng.Uniform() - 1);
        Point3 corner(3 * rng.Uniform() - 2, 3 * rng.Uniform() - 2, far);
        Vector3 x(0.1f + rng.Uniform(), 0, 0), y(0, 0.1f + rng.Uniform(), 0);
        SphericalRectangle r(Point3(0), corner, x, y);
        Point2 u = rng.Uniform2(), st = r.Sample(u), back = r.Invert(corner + st.x * x + st.y * y);
        EXPECT_NEAR(back.x, u.x, 1e-3);
        EXPECT_NEAR(back.y, u.y, 1e-3);
    }
}

}  // namespace
}  // namespace pbrt::test
