#include "pbrt/lights/light_bounds.h"

#include <gtest/gtest.h>

#include "pbrt/math/frame.h"
#include "support/sampling.h"

namespace pbrt {
namespace {

/// The importance computed with angles, as the papers write it, without the slack of LightBounds::Importance.
double SlowImportance(const LightBounds &b, const Point3 &p, const Normal3 &n) {
    Point3 c = b.Centroid();
    double d2 = double(DistanceSquared(p, c)), r = double(Length(b.bounds.Diagonal())) / 2;
    double falloff = b.phi / std::max(d2, r);
    if (d2 <= r * r) return falloff;
    Vector3 wi = Normalize(p - c);
    double cosAxis = double(Dot(b.w, wi));
    if (b.twoSided) cosAxis = std::abs(cosAxis);
    double extent = std::asin(std::min(1.0, r / std::sqrt(d2)));
    double angle = std::acos(std::clamp(cosAxis, -1.0, 1.0)) - std::acos(double(b.cosTheta_o)) - extent;
    angle = std::max(0.0, angle);
    if (angle >= std::acos(double(b.cosTheta_e))) return 0;
    double result = falloff * std::cos(angle);
    if (n != Normal3(0)) {
        double receiver = std::acos(std::min(1.0, std::abs(double(Dot(wi, n))))) - extent;
        result *= std::cos(std::max(0.0, receiver));
    }
    return result;
}

LightBounds RandomBounds(Rng &rng) {
    LightBounds b;
    Point3 low(rng.Uniform(), rng.Uniform(), rng.Uniform());
    b.bounds = Bounds3(low, low + Vector3(rng.Uniform(), rng.Uniform(), rng.UniformInt(2) ? Float(0) : rng.Uniform()));
    b.w = SampleUniformSphere(rng.Uniform2());
    b.phi = 10 * double(rng.Uniform()) + 0.1;
    b.cosTheta_o = rng.UniformInt(2) ? Float(1) : 2 * rng.Uniform() - 1;
    b.cosTheta_e = rng.UniformInt(2) ? Float(0) : rng.Uniform();
    b.twoSided = rng.UniformInt(2) == 1;
    return b;
}

TEST(LightBounds, ImportanceEqualsTheSlowTwin) {
    Rng rng(1);
    int positive = 0;
    for (int i = 0; i < 200000; ++i) {
        LightBounds b = RandomBounds(rng);
        Point3 p = Point3(1) + SampleUniformSphere(rng.Uniform2()) * (4 * rng.Uniform());
        Normal3 n = rng.UniformInt(3) ? SampleUniformSphere(rng.Uniform2()) : Normal3(0);
        double slow = SlowImportance(b, p, n), fast = double(b.Importance(p, n));
        positive += slow > 0;
        double peak = b.phi / double(std::max(DistanceSquared(p, b.Centroid()), Length(b.bounds.Diagonal()) / 2));
        if (slow > 0) {
            ASSERT_GT(fast, 0);
            ASSERT_NEAR(fast, slow, 4e-3 * peak);
        } else if (fast > 0) {
            // Only in the thin shell that the slack adds may the fast one alone be positive.
            LightBounds wider = b;
            wider.cosTheta_e = std::cos(std::acos(b.cosTheta_e) + Float(5e-3));
            ASSERT_GT(SlowImportance(wider, p, Normal3(0)), 0);
        }
    }
    EXPECT_GT(positive, 50000);
}

TEST(LightBounds, UnionIsImportantWhereverAPartShines) {
    Rng rng(2);
    for (int i = 0; i < 200000; ++i) {
        LightBounds a = RandomBounds(rng), b = RandomBounds(rng);
        LightBounds u = Union(a, b);
        EXPECT_DOUBLE_EQ(u.phi, a.phi + b.phi);
        // A ray from some emitter in the box: its normal is within theta_o of the axis, and the direction within
        // theta_e of the normal.
        Point3 from = a.bounds.low + a.bounds.Diagonal() * Vector3(rng.Uniform(), rng.Uniform(), rng.Uniform());
        Vector3 normal = Frame::FromZ(a.w).FromLocal(test::SampleUniformCone(rng.Uniform2(), a.cosTheta_o));
        Vector3 d = Frame::FromZ(normal).FromLocal(test::SampleUniformCone(rng.Uniform2(), a.cosTheta_e));
        if (a.twoSided && rng.UniformInt(2)) d = -d;
        Point3 p = from + d * (3 * rng.Uniform());
        ASSERT_GT(a.Importance(p, Normal3(0)), 0);
        ASSERT_GT(u.Importance(p, Normal3(0)), 0);
        Normal3 n = SampleUniformSphere(rng.Uniform2());
        if (AbsDot(n, d) < 1e-3f) continue;
        ASSERT_GT(a.Importance(p, n), 0);
        ASSERT_GT(u.Importance(p, n), 0);
    }
}

TEST(LightBounds, WithoutPowerAreUnimportantAndChangeNoUnion) {
    LightBounds none;
    none.bounds = Bounds3(Point3(0), Point3(1));
    for (Float at : {0.5f, 3.f}) EXPECT_EQ(none.Importance(Point3(at), Normal3(0)), 0);
    Rng rng(3);
    LightBounds a = RandomBounds(rng), u = Union(LightBounds(), a);
    EXPECT_EQ(u.phi, a.phi);
    EXPECT_EQ(u.bounds.low, a.bounds.low);
    EXPECT_EQ(u.cosTheta_o, a.cosTheta_o);
}

TEST(LightBounds, ImportanceIsFiniteAtAnyPointAndScale) {
    for (Float scale : {Float(1e-15), Float(1e-4), Float(1), Float(1e4), Float(1e15)}) {
        LightBounds point;
        point.bounds = Bounds3(Point3(scale));
        point.phi = 1e6;
        point.cosTheta_o = -1;
        for (Point3 p : {Point3(scale), Point3(0), Point3(scale * Float(1.0000001)), Point3(-scale)}) {
            Float i = point.Importance(p, Normal3(0, 0, 1));
            EXPECT_TRUE(std::isfinite(i)) << scale;
            EXPECT_GE(i, 0) << scale;
        }
        EXPECT_GT(point.Importance(Point3(scale), Normal3(0, 0, 1)), 0)
            << "the importance at the light itself must be positive";
    }
}

}  // namespace
}  // namespace pbrt
