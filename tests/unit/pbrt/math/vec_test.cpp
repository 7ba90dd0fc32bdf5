#include "pbrt/math/vec.h"

#include <gtest/gtest.h>

#include "pbrt/math/frame.h"
#include "pbrt/math/ray.h"
#include "support/sampling.h"

namespace pbrt::test {
namespace {

double AngleInDouble(const Vector3 &a, const Vector3 &b) {
    glm::dvec3 p(a), q(b);
    return std::atan2(glm::length(glm::cross(p, q)), glm::dot(p, q));
}

TEST(Vec, CrossOfNearlyParallelVectorsKeepsItsDigits) {
    Rng rng(1);
    for (int i = 0; i < 1000; ++i) {
        Vector3 a = RandomDirection(rng) * 1000.f, b = a * (1 + 1e-6f) + RandomDirection(rng) * 1e-3f;
        glm::dvec3 exact = glm::cross(glm::dvec3(a), glm::dvec3(b));
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(double(Cross(a, b)[k]), exact[k], 2e-7 * std::abs(exact[k]) + 1e-30) << i;
    }
}

TEST(Vec, CrossIsRightHanded) {
    EXPECT_EQ(Cross({1, 0, 0}, {0, 1, 0}), Vector3(0, 0, 1));
    EXPECT_EQ(Cross({0, 1, 0}, {0, 0, 1}), Vector3(1, 0, 0));
}

TEST(Vec, AngleBetweenIsAccurateAtBothEnds) {
    Rng rng(2);
    for (Float step : {1e-5f, 1e-4f, 1e-2f, 0.5f, 1.5f}) {
        for (int i = 0; i < 300; ++i) {
            Vector3 a = RandomDirection(rng);
            Vector3 b = Normalize(a + step * RandomDirection(rng));
            // Both inputs have unit length only up to rounding, which alone changes the angle by some 1e-7.
            EXPECT_NEAR(double(AngleBetween(a, b)), AngleInDouble(a, b), 5e-7 + 1e-6 * double(step));
            EXPECT_NEAR(double(AngleBetween(a, -b)), AngleInDouble(a, -b), 5e-7 + 1e-6 * double(step));
        }
    }
    Vector3 d = RandomDirection(rng);
    EXPECT_EQ(AngleBetween(d, d), 0);
    EXPECT_EQ(AngleBetween(d, -d), Pi);
}

TEST(Vec, CoordinateSystemIsOrthonormalAndRightHanded) {
    Rng rng(3);
    std::vector<Vector3> directions = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {1, 0, -0.f}};
    for (int i = 0; i < 1000; ++i) directions.push_back(RandomDirection(rng));
    for (int i = 0; i < 100; ++i) directions.push_back(Normalize(Vector3(0, 0, -1) + 1e-4f * RandomDirection(rng)));
    for (const Vector3 &v : directions) {
        Vector3 s, t;
        CoordinateSystem(v, &s, &t);
        EXPECT_NEAR(Length(s), 1, 2e-6f);
        EXPECT_NEAR(Length(t), 1, 2e-6f);
        EXPECT_NEAR(Dot(s, v), 0, 2e-6f);
        EXPECT_NEAR(Dot(t, v), 0, 2e-6f);
        EXPECT_NEAR(Length(Cross(s, t) - v), 0, 3e-6f);
    }
}

TEST(Vec, LerpHitsItsEndsExactly) {
    EXPECT_EQ(Lerp(0.f, 0.1f, 0.7f), 0.1f);
    EXPECT_EQ(Lerp(1.f, 0.1f, 0.7f), 0.7f);
    EXPECT_EQ(Lerp(1.f, Vector3(1e8f), Vector3(1)), Vector3(1));
}

TEST(Vec, OneMinusEpsilonIsTheLargestFloatBelowOne) {
    EXPECT_EQ(std::nextafter(OneMinusEpsilon, 2.f), 1.f);
    EXPECT_EQ(1.f + MachineEpsilon, 1.f);
    EXPECT_GT(1.f + 1.01f * MachineEpsilon, 1.f);
}

TEST(Vec, SafeFunctionsClampRoundingOnly) {
    EXPECT_EQ(SafeSqrt(-1e-7f), 0);
    EXPECT_EQ(SafeACos(1.0000001f), 0);
    EXPECT_FLOAT_EQ(SafeASin(-1.0000001f), -Pi / 2);
    EXPECT_FLOAT_EQ(SafeSqrt(2.25f), 1.5f);
}

TEST(Frame, FromLocalUndoesToLocal) {
    Rng rng(4);
    for (int i = 0; i < 200; ++i) {
        Vector3 z = RandomDirection(rng), x = RandomDirection(rng) * 3.f, v = RandomDirection(rng);
        for (const Frame &f : {Frame::FromZ(z), Frame::FromXZ(x, z)}) {
            EXPECT_NEAR(Length(f.FromLocal(f.ToLocal(v)) - v), 0, 1e-6f);
            EXPECT_EQ(f.z, z);
            EXPECT_NEAR(Length(Cross(f.x, f.y) - f.z), 0, 1e-5f);
        }
        // The x axis stays in the half plane of the given x.
        EXPECT_GT(Dot(Frame::FromXZ(x, z).x, x), 0);
    }
}

TEST(Frame, ParallelAxesFallBackToSomeFrame) {
    for (const Vector3 &x : {Vector3(0, 0, 5), Vector3(0, 0, 0), Vector3(1e-12f, 0, 1)}) {
        Frame f = Frame::FromXZ(x, {0, 0, 1});
        EXPECT_NEAR(Length(f.x), 1, 1e-6f);
        EXPECT_NEAR(Dot(f.x, f.z), 0, 1e-6f);
    }
}

TEST(Frame, TrigonometryMatchesAngles) {
    Float theta = 0.7f, phi = 4.1f;
    Vector3 w = SphericalDirection(std::sin(theta), std::cos(theta), phi);
    EXPECT_NEAR(SinTheta(w), std::sin(theta), 1e-6f);
    EXPECT_FALSE(SameHemisphere({0, 0, 1}, {1, 0, 0}));
    EXPECT_TRUE(SameHemisphere({0, 0, -1}, {0, 1, -0.1f}));
}

TEST(Ray, OffsetOriginLeavesTheErrorBoxOnTheRightSide) {
    Rng rng(5);
    for (int i = 0; i < 5000; ++i) {
        Point3 p = RandomDirection(rng) * std::exp2(20 * rng.Uniform() - 10);
        Normal3 n = RandomDirection(rng);
        Vector3 w = RandomDirection(rng), error = Abs(p) * (MachineEpsilon * (1 + 20 * rng.Uniform()));
        if (i % 7 == 0) error = Vector3(0);
        Point3 o = OffsetRayOrigin(p, error, n, w);
        glm::dvec3 nd(n);
        double side = Dot(w, n) < 0 ? -1 : 1;
        double boxReach = glm::dot(glm::abs(nd), glm::dvec3(error));
        double moved = side * glm::dot(glm::dvec3(o) - glm::dvec3(p), nd);
        EXPECT_GE(moved, boxReach * 0.999999) << i;
        EXPECT_LE(moved, 1.01 * boxReach + 4e-7 * glm::length(glm::dvec3(p)));
    }
}

TEST(Ray, NextFloatIsThatOfTheLibrary) {
    constexpr Float kInfinity = std::numeric_limits<Float>::infinity();
    Rng rng(5);
    std::vector<Float> values = {
        0.0f, -0.0f, 1, -1, std::numeric_limits<Float>::max(), std::numeric_limits<Float>::denorm_min()};
    for (int i = 0; i < 10000; ++i) values.push_back(std::ldexp(rng.Uniform() - 0.5f, int(rng.Uniform() * 280) - 150));
    for (const Float x : values) {
        EXPECT_EQ(NextFloat(x, true), std::nextafter(x, kInfinity)) << x;
        EXPECT_EQ(NextFloat(x, false), std::nextafter(x, -kInfinity)) << x;
    }
}

TEST(Ray, DifferentialScaleShrinksTowardsTheRay) {
    RayDifferential d{true, {2, 2, 3}, {1, 4, 3}, {0.1f, 0, 1}, {0, 0.2f, 1}};
    d.Scale({.o = {1, 2, 3}, .d = {0, 0, 1}}, 0.5f);
    EXPECT_EQ(d.rxOrigin, Point3(1.5f, 2, 3));
    EXPECT_EQ(d.ryOrigin, Point3(1, 3, 3));
    EXPECT_EQ(d.rxDirection, Vector3(0.05f, 0, 1));
    EXPECT_EQ(d.ryDirection, Vector3(0, 0.1f, 1));
}

}  // namespace
}  // namespace pbrt::test
