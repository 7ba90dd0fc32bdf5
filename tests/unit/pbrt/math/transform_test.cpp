#include "pbrt/math/transform.h"

#include <gtest/gtest.h>

#include "pbrt/math/rng.h"
#include "support/sampling.h"

namespace pbrt::test {
namespace {

Transform RandomAffine(Rng &rng) {
    return Transform::Translate(10.f * RandomVector(rng)) * Transform::Rotate(360 * rng.Uniform(), RandomVector(rng)) *
           Transform::Scale({0.5f + rng.Uniform(), -0.5f - rng.Uniform(), 2 + rng.Uniform()}) *
           Transform::Rotate(360 * rng.Uniform(), RandomVector(rng));
}

void ExpectNear(const Vector3 &a, const Vector3 &b, Float tolerance) {
    EXPECT_LE(Distance(a, b), tolerance) << a.x << " " << a.y << " " << a.z << " vs " << b.x << " " << b.y << " "
                                         << b.z;
}

TEST(Transform, FileOrderPutsTheTranslationLast) {
    Transform t = Transform::FromFile({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1});
    EXPECT_EQ(t.Point({1, 1, 1}), Point3(6, 7, 8));
    EXPECT_EQ(t.Vector({1, 1, 1}), Vector3(1, 1, 1));
    Transform r = Transform::FromFile({0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    EXPECT_EQ(r.Vector({1, 0, 0}), Vector3(0, 1, 0));
}

TEST(Transform, RotationFollowsTheRightHand) {
    ExpectNear(Transform::Rotate(90, {0, 0, 2}).Point({1, 0, 0}), {0, 1, 0}, 1e-6f);
    ExpectNear(Transform::Rotate(90, {1, 0, 0}).Point({0, 1, 0}), {0, 0, 1}, 1e-6f);
    ExpectNear(Transform::Rotate(-90, {0, 3, 0}).Point({1, 0, 0}), {0, 0, 1}, 1e-6f);
}

TEST(Transform, ProductAppliesTheRightFactorFirst) {
    Transform t = Transform::Translate({1, 0, 0}) * Transform::Scale({2, 2, 2});
    EXPECT_EQ(t.Point({1, 1, 1}), Point3(3, 2, 2));
    EXPECT_EQ(t.InversePoint({3, 2, 2}), Point3(1, 1, 1));
}

TEST(Transform, InverseUndoes) {
    Rng rng(1);
    for (int i = 0; i < 200; ++i) {
        Transform t = RandomAffine(rng), direct(t.Matrix());
        Point3 p = 10.f * RandomVector(rng);
        ExpectNear(t.InversePoint(t.Point(p)), p, 1e-4f);
        ExpectNear(direct.InversePoint(t.Point(p)), p, 1e-4f);
        ExpectNear(t.Inverse().Point(t.Point(p)), p, 1e-4f);
        ExpectNear(t.InverseVector(t.Vector(p)), p, 1e-4f);
        ExpectNear(t.InverseNormal(t.Normal(p)), p, 1e-4f);
    }
}

TEST(Transform, InverseOfBadlyScaledMatricesKeepsItsDigits) {
    // A small object far from the origin, as exported scenes have them.
    glm::mat4 m = (Transform::Translate({1234.5f, -2345.6f, 345.6f}) * Transform::Rotate(33, {1, 2, 3}) *
                   Transform::Scale({1e-3f, 2e-3f, 1e-2f}))
                      .Matrix();
    Transform t(m);
    glm::dmat4 exact = glm::inverse(glm::dmat4(m));
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            EXPECT_NEAR(double(t.InverseMatrix()[c][r]), exact[c][r], 1e-7 * std::abs(exact[c][r]) + 1e-12);
}

TEST(Transform, InverseOfAffineIsExactlyAffine) {
    Rng rng(2);
    for (int i = 0; i < 200; ++i) {
        glm::mat4 inverse = Transform(RandomAffine(rng).Matrix()).InverseMatrix();
        for (int c = 0; c < 4; ++c) EXPECT_EQ(inverse[c][3], c == 3 ? 1 : 0);
    }
}

TEST(Transform, NormalsStayPerpendicular) {
    Rng rng(3);
    for (int i = 0; i < 200; ++i) {
        Transform t = RandomAffine(rng);
        Vector3 v = Normalize(RandomVector(rng)), n = Normalize(Cross(v, RandomVector(rng)));
        EXPECT_NEAR(Dot(Normalize(t.Normal(n)), Normalize(t.Vector(v))), 0, 1e-5f);
        EXPECT_GT(Dot(t.Normal(n), t.Vector(n)), 0);
    }
}

TEST(Transform, LookAtIsLeftHandedAndLooksAlongZ) {
    Point3 eye(1, 2, -5), look(3, 1, 4);
    std::optional<Transform> t = Transform::LookAt(eye, look, {0.1f, 1, 0});
    ASSERT_TRUE(t);
    ExpectNear(t->Point(eye), {0, 0, 0}, 1e-5f);
    ExpectNear(t->Point(look), {0, 0, Distance(eye, look)}, 1e-5f);
    Vector3 up = t->Vector({0.1f, 1, 0});
    EXPECT_NEAR(up.x, 0, 1e-6f);
    EXPECT_GT(up.y, 0);
    // The camera looks from -z and sees world x on the right: the world of pbrt is left-handed.
    EXPECT_GT(t->Vector({1, 0, 0}).x, 0);
    EXPECT_FALSE(t->SwapsHandedness());
    EXPECT_TRUE(Transform::LookAt({0, 0, -1}, {0, 0, 0}, {0, 1, 0})->IsIdentity() ||
                Transform::LookAt({0, 0, -1}, {0, 0, 0}, {0, 1, 0})->Point({2, 3, 0}) == Point3(2, 3, 1));
}

TEST(Transform, LookAtWithoutADirectionIsNothing) {
    EXPECT_FALSE(Transform::LookAt({0, 0, 0}, {0, 0, 0}, {0, 1, 0}));
    EXPECT_FALSE(Transform::LookAt({0, 0, 0}, {0, 2, 0}, {0, -1, 0}));
    EXPECT_FALSE(Transform::LookAt({0, 0, 0}, {0, 2, 0}, {0, 0, 0}));
}

TEST(Transform, PerspectiveMapsTheFrustumToTheUnitBox) {
    Transform t = Transform::Perspective(60, 0.5f, 20);
    Float tan = std::tan(Radians(30));
    ExpectNear(t.Point({3 * tan, -3 * tan, 3}), {1, -1, t.Point({0, 0, 3}).z}, 1e-5f);
    ExpectNear(t.Point({0, 0, 0.5f}), {0, 0, 0}, 1e-6f);
    ExpectNear(t.Point({0, 0, 20}), {0, 0, 1}, 1e-6f);
    ExpectNear(t.InversePoint(t.Point({1, 2, 7})), {1, 2, 7}, 1e-4f);
    Transform o = Transform::Orthographic(2, 6);
    ExpectNear(o.Point({1, 2, 2}), {1, 2, 0}, 1e-6f);
    ExpectNear(o.Point({1, 2, 6}), {1, 2, 1}, 1e-6f);
}

TEST(Transform, HandednessAndSingularityDoNotDependOnSize) {
    for (Float s : {1e-15f, 1.f, 1e12f}) {
        EXPECT_TRUE(Transform::Scale({-s, s, s}).SwapsHandedness()) << s;
        EXPECT_FALSE(Transform::Scale({-s, -s, s}).SwapsHandedness()) << s;
        EXPECT_FALSE(Transform::Scale({s, s, s}).IsSingular()) << s;
    }
    EXPECT_TRUE(Transform(glm::mat4(glm::vec4(1, 0, 0, 0), glm::vec4(0), glm::vec4(0, 0, 1, 0), glm::vec4(0, 0, 0, 1)))
                    .IsSingular());
}

TEST(Transform, PointErrorBoundsTheRounding) {
    Rng rng(4);
    for (int i = 0; i < 2000; ++i) {
        Transform t = RandomAffine(rng);
        Point3 p = 100.f * RandomVector(rng), error = Abs(RandomVector(rng)) * 1e-4f;
        Point3 shifted = p + error * RandomVector(rng);
        glm::dvec3 exact(glm::dmat4(t.Matrix()) * glm::dvec4(glm::dvec3(p), 1));
        glm::dvec3 exactShifted(glm::dmat4(t.Matrix()) * glm::dvec4(glm::dvec3(shifted), 1));
        for (int k = 0; k < 3; ++k) {
            EXPECT_LE(std::abs(double(t.Point(p)[k]) - exact[k]), double(t.PointError(p)[k]));
            EXPECT_LE(std::abs(double(t.Point(p)[k]) - exactShifted[k]), double(t.PointError(p, error)[k]));
        }
    }
}

}  // namespace
}  // namespace pbrt::test
