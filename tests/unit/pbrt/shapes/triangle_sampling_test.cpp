#include "pbrt/shapes/solid_angle_sampling.h"

#include <gtest/gtest.h>

#include "pbrt/math/rng.h"
#include "support/statistics.h"

// The two ways in which triangles and rectangles are sampled, and the limit between them.

namespace pbrt::test {
namespace {

struct Seen {
    Point3 p[4];  ///< the fourth corner is used by rectangles only
    ShapeSampleContext from;
    Vector3 Edge(int i) const { return p[i] - p[0]; }
};

Vector3 SomeDirection(Rng &rng) {
    for (;;) {
        const Vector3 v(rng.Uniform() * 2 - 1, rng.Uniform() * 2 - 1, rng.Uniform() * 2 - 1);
        if (LengthSquared(v) > 0.01f && LengthSquared(v) < 1) return Normalize(v);
    }
}

/// A triangle that is no sliver, or a rectangle, whose squared diameter is `size` of the squared distance of its
/// nearest corner; all of it is above the receiver's horizon.
Seen SomeShape(Rng &rng, Float size, bool rectangle) {
    for (;;) {
        Seen s;
        for (Point3 &p : s.p) p = rng.Uniform() * SomeDirection(rng);
        if (rectangle) {
            const Vector3 x = s.p[1] - s.p[0];
            Vector3 y = s.p[2] - s.p[0];
            y -= x * (Dot(x, y) / LengthSquared(x));
            s.p[2] = s.p[0] + y;
            s.p[3] = s.p[1] + y;
        } else {
            s.p[3] = s.p[2];
        }
        Float diameter2 = 0;
        for (const Point3 &a : s.p)
            for (const Point3 &b : s.p) diameter2 = std::max(diameter2, DistanceSquared(a, b));
        const Normal3 normal = Cross(s.Edge(1), s.Edge(2));
        if (Length(normal) < 0.1f * diameter2) continue;
        const Vector3 away = SomeDirection(rng);
        if (AbsDot(away, Normalize(normal)) < 0.05f) continue;
        auto nearest2 = [&](Float at) {
            Float nearest = Infinity;
            for (const Point3 &p : s.p) nearest = std::min(nearest, DistanceSquared(p, s.p[0] + away * at));
            return nearest;
        };
        Float low = 0, high = 100;
        for (int i = 0; i < 60; ++i) {
            const Float middle = (low + high) / 2;
            (nearest2(middle) * size < diameter2 ? low : high) = middle;
        }
        s.from.p = s.p[0] + away * high;
        if (std::abs(nearest2(high) * size / diameter2 - 1) > 1e-3f) continue;
        for (int i = 0; i < 50; ++i) {
            s.from.ns = s.from.n = SomeDirection(rng);
            bool above = true;
            for (const Point3 &p : s.p) above &= Dot(p - s.from.p, s.from.ns) > 0;
            if (above) return s;
        }
    }
}

/// 1 / density and cosine over density of samples that are spread evenly, and the largest difference of Pdf to the
/// density of the sample.
struct Results {
    RunningStatistics solidAngle, irradiance;
    double shareOfQuarter = 0, difference = 0;
    bool inPlane = false;
};
Results Try(const Seen &s, bool rectangle, Rng &rng) {
    constexpr int kSide = 40;
    Results r;
    for (int i = 0; i < kSide * kSide; ++i) {
        const Point2 u = (Point2(i % kSide, i / kSide) + rng.Uniform2()) / Float(kSide);
        Float pdf, back;
        Point3 p;
        bool isInQuarter;
        if (rectangle) {
            const RectangleSampling sampling(s.from, s.p[0], s.Edge(1), s.Edge(2));
            const RectangleSampling::Point at = sampling.Sample(u);
            p = s.p[0] + at.st.x * s.Edge(1) + at.st.y * s.Edge(2);
            pdf = at.pdf;
            back = sampling.Pdf(p);
            r.inPlane = sampling.IsInPlane();
            isInQuarter = at.st.x < 0.5f && at.st.y < 0.5f;
        } else {
            const TriangleSampling sampling(s.from, s.p[0], s.p[1], s.p[2]);
            const TriangleSampling::Point at = sampling.Sample(u);
            p = at.barycentrics.x * s.p[0] + at.barycentrics.y * s.p[1] + at.barycentrics.z * s.p[2];
            pdf = at.pdf;
            back = sampling.Pdf(Normalize(p - s.from.p));
            r.inPlane = sampling.IsInPlane();
            isInQuarter = at.barycentrics.x > 0.5f;
        }
        if (isInQuarter) r.shareOfQuarter += 1 / double(pdf) / (kSide * kSide);
        r.difference = std::max(r.difference, std::abs(double(back) / double(pdf) - 1));
        r.solidAngle.Add(1 / double(pdf));
        r.irradiance.Add(double(Dot(Normalize(p - s.from.p), s.from.ns)) / double(pdf));
    }
    return r;
}

double SolidAngle(const Point3 &from, const Point3 &a, const Point3 &b, const Point3 &c) {
    return double(SphericalTriangle(Normalize(a - from), Normalize(b - from), Normalize(c - from)).Area());
}

TEST(FlatLights, DensitiesHoldOnBothSidesOfTheLimit) {
    for (bool rectangle : {false, true})
        for (Float relative : {0.01f, 0.5f, 0.98f, 1.02f, 2.0f, 8.0f}) {
            Rng rng(3);
            RunningStatistics whole, quarter;
            for (int i = 0; i < 200; ++i) {
                const Seen s = SomeShape(rng, TriangleSampling::kMaxSizeSquared * relative, rectangle);
                const Results r = Try(s, rectangle, rng);
                ASSERT_EQ(r.inPlane, relative < 1) << relative;
                // Near corner 1 rounding moves u.x, on which the density depends little there.
                ASSERT_LT(r.difference, 1e-2) << relative << " " << rectangle;
                double all = SolidAngle(s.from.p, s.p[0], s.p[1], s.p[2]);
                if (rectangle) all += SolidAngle(s.from.p, s.p[3], s.p[1], s.p[2]);
                const Point3 middle1 = (s.p[0] + s.p[1]) / Float(2), middle2 = (s.p[0] + s.p[2]) / Float(2);
                double part = SolidAngle(s.from.p, s.p[0], middle1, middle2);
                if (rectangle) part += SolidAngle(s.from.p, (s.p[0] + s.p[3]) / Float(2), middle1, middle2);
                whole.Add(r.solidAngle.mean / all - 1);
                quarter.Add(r.shareOfQuarter / part - 1);
                ASSERT_NEAR(r.solidAngle.mean / all, 1, 0.02) << relative << " " << rectangle;
            }
            EXPECT_NEAR(whole.mean, 0, 4 * whole.StandardError() + 1e-4) << relative << " " << rectangle;
            EXPECT_NEAR(quarter.mean, 0, 4 * quarter.StandardError() + 1e-4) << relative << " " << rectangle;
        }
}

TEST(FlatLights, VarianceAtTheLimitIsSmall) {
    for (bool rectangle : {false, true})
        for (Float relative : {0.25f, 0.98f, 1.02f, 4.0f}) {
            Rng rng(5);
            RunningStatistics variance;
            for (int i = 0; i < 400; ++i) {
                const Seen s = SomeShape(rng, TriangleSampling::kMaxSizeSquared * relative, rectangle);
                const Results r = Try(s, rectangle, rng);
                variance.Add(r.irradiance.Variance() / (r.irradiance.mean * r.irradiance.mean));
            }
            EXPECT_LT(variance.mean, 0.004) << (rectangle ? "rectangles of " : "triangles of ") << relative;
        }
}

/// Integral of the cosine to unit vector n over a triangle above the horizon (Lambert).
double Irradiance(const glm::dvec3 &n, const glm::dvec3 (&to)[3]) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 a = glm::normalize(to[i]), b = glm::normalize(to[(i + 1) % 3]), axis = glm::cross(a, b);
        sum += std::atan2(glm::length(axis), glm::dot(a, b)) * glm::dot(glm::normalize(axis), n) / 2;
    }
    return std::abs(sum);
}

/// Half of a square of half width r at height 2, in any order of its corners, seen from below the diagonal.
TEST(FlatLights, MayHaveNearlyAntipodalCorners) {
    constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    constexpr int kSide = 40;
    const Normal3 up(0, 1, 0);
    Rng rng(11);
    for (const Float r : {20.f, 60.f, 1e3f, 1e4f, 1e5f, 1e6f, 1e7f})
        for (const int(&order)[3] : kOrders)
            for (const Normal3 &ns : {Normal3(0), up, Normalize(Vector3(.5f, 1, .7f)), Normal3(1, 0, 0)}) {
                const Point3 corners[3] = {{-r, 2, -r}, {r, 2, -r}, {-r, 2, r}};
                const Point3 p[3] = {corners[order[0]], corners[order[1]], corners[order[2]]};
                ShapeSampleContext from;
                from.p = {.25f, 0, -.375f};
                from.n = from.ns = ns;
                const TriangleSampling sampling(from, p[0], p[1], p[2]);
                ASSERT_FALSE(sampling.IsInPlane());
                EXPECT_EQ(sampling.IsInDouble(), r > 50) << r;
                RunningStatistics irradiance, solidAngle;
                for (int i = 0; i < kSide * kSide; ++i) {
                    const Point2 u = (Point2(i % kSide, i / kSide) + rng.Uniform2()) / Float(kSide);
                    const TriangleSampling::Point at = sampling.Sample(u);
                    const Point3 b = at.barycentrics.x * p[0] + at.barycentrics.y * p[1] + at.barycentrics.z * p[2];
                    const Vector3 wi = Normalize(sampling.IsInDouble() ? at.offset : b - from.p);
                    ASSERT_NEAR(sampling.Pdf(wi) / at.pdf, 1, 1e-2) << r << " " << u.x << " " << u.y;
                    EXPECT_LT(Distance(b, from.p + at.offset), sampling.IsInDouble() ? 1e-6f * r : Infinity);
                    irradiance.Add(double(wi.y) / double(at.pdf));
                    solidAngle.Add(1 / double(at.pdf));
                }
                glm::dvec3 to[3];
                for (int i = 0; i < 3; ++i) to[i] = glm::dvec3(p[i]) - glm::dvec3(from.p);
                const double exact = Irradiance(up, to);
                EXPECT_NEAR(irradiance.mean, exact, 4 * irradiance.StandardError() + 1e-4 * exact) << r;
                EXPECT_NEAR(irradiance.mean, exact, 0.02 * exact) << r;
                const glm::dvec3 a = glm::normalize(to[0]), d = glm::normalize(to[1]), c = glm::normalize(to[2]);
                const double area = 2 * std::atan2(std::abs(glm::dot(a, glm::cross(d, c))),
                                                   1 + glm::dot(a, d) + glm::dot(a, c) + glm::dot(d, c));
                EXPECT_NEAR(solidAngle.mean, area, 4 * solidAngle.StandardError() + 1e-4 * area) << r;
            }
}

TEST(FlatLights, CornersAndPlanesYieldNothingButNoNumbersThatAreNone) {
    const Point3 p[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (const Point3 &from : {p[0], p[1], Point3(3, 2, 0), Point3(0.2f, 0.2f, 0)}) {
        ShapeSampleContext context;
        context.p = from;
        context.n = context.ns = Normal3(0, 0, 1);
        const TriangleSampling::Point t = TriangleSampling(context, p[0], p[1], p[2]).Sample({0.3f, 0.6f});
        EXPECT_FALSE(t.pdf > 0 && std::isfinite(t.pdf)) << t.pdf;
        const RectangleSampling::Point r = RectangleSampling(context, p[0], p[1], p[2]).Sample({0.3f, 0.6f});
        EXPECT_FALSE(r.pdf > 0 && std::isfinite(r.pdf)) << r.pdf;
    }
}

}  // namespace
}  // namespace pbrt::test
