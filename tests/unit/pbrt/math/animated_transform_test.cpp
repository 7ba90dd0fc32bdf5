#include "pbrt/math/animated_transform.h"

#include <gtest/gtest.h>

#include "pbrt/math/rng.h"
#include "support/sampling.h"

namespace pbrt::test {
namespace {

/// Q diag(d) transpose(Q) with d > 0: a stretch along three orthogonal axes.
glm::mat4 RandomStretch(Rng &rng) {
    const glm::mat4 q = Transform::Rotate(360 * rng.Uniform(), RandomVector(rng)).Matrix();
    const Vector3 d = Vector3(0.3f) + Abs(RandomVector(rng));
    return q * Transform::Scale(d).Matrix() * glm::transpose(q);
}

void ExpectSameMatrix(const glm::mat4 &a, const glm::mat4 &b, Float tolerance) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) EXPECT_NEAR(a[c][r], b[c][r], tolerance) << "column " << c << " row " << r;
}

/// The reference is a motion made of known parts, whose rotation turns about its axis by a share of its angle.
TEST(AnimatedTransform, MovesByItsParts) {
    Rng rng(1);
    for (int i = 0; i < 200; ++i) {
        const Vector3 from = 5.0f * RandomVector(rng), to = 5.0f * RandomVector(rng), axis = RandomVector(rng);
        const Float angle = i % 4 == 0 ? 0.01f * rng.Uniform() : 178 * rng.Uniform();
        const Float mirror = i % 3 == 0 ? -1.0f : 1.0f;
        const glm::mat4 first = Transform::Rotate(360 * rng.Uniform(), RandomVector(rng)).Matrix();
        const glm::mat4 s0 = RandomStretch(rng), s1 = RandomStretch(rng);
        auto twin = [&](Float t) {
            glm::mat4 stretch = s0 * (1 - t) + s1 * t;
            stretch = glm::mat4(glm::mat3(stretch) * mirror);
            return Transform::Translate(Lerp(t, from, to)).Matrix() * Transform::Rotate(angle * t, axis).Matrix() *
                   first * stretch;
        };
        const AnimatedTransform motion(Transform(twin(0)), 2, Transform(twin(1)), 4);
        for (Float t : {0.0f, 0.1f, 0.5f, 0.77f, 1.0f}) ExpectSameMatrix(motion.At(2 + 2 * t).Matrix(), twin(t), 2e-5f);
        ExpectSameMatrix(motion.At(2.5f).InverseMatrix() * twin(0.25f), glm::mat4(1), 2e-4f);
    }
}

TEST(AnimatedTransform, StandsStillOutsideItsTimes) {
    const Transform a = Transform::Translate({1, 2, 3}) * Transform::Scale({1, 2, 3});
    const Transform b = Transform::Rotate(50, {1, 2, 3});
    const AnimatedTransform motion(a, 0.25f, b, 0.75f);
    EXPECT_TRUE(motion.IsAnimated());
    for (Float time : {-3.0f, 0.0f, 0.25f}) EXPECT_EQ(motion.At(time), a);
    for (Float time : {0.75f, 0.8f, 9.0f}) EXPECT_EQ(motion.At(time), b);
    EXPECT_FALSE(motion.At(0.5f) == a);

    const AnimatedTransform still = b;
    EXPECT_FALSE(still.IsAnimated());
    EXPECT_FALSE(AnimatedTransform(a, 0, a, 1).IsAnimated());
    EXPECT_EQ(still.At(0.3f), b);
}

TEST(AnimatedTransform, TurnsTheShortWay) {
    const AnimatedTransform motion({}, 0, Transform::Rotate(270, {0, 0, 1}), 1);
    ExpectSameMatrix(motion.At(0.5f).Matrix(), Transform::Rotate(-45, {0, 0, 1}).Matrix(), 1e-6f);
}

/// The interpolation must not depend on how rendering space is turned and moved against world space.
TEST(AnimatedTransform, CommutesWithAnOuterTransform) {
    Rng rng(2);
    for (int i = 0; i < 50; ++i) {
        auto random = [&] {
            return Transform::Translate(RandomVector(rng)) * Transform::Rotate(360 * rng.Uniform(), RandomVector(rng)) *
                   Transform(RandomStretch(rng));
        };
        const Transform a = random(), b = random();
        const Transform place = Transform::Translate(RandomVector(rng)) * Transform::Rotate(80, RandomVector(rng));
        const AnimatedTransform motion(a, 0, b, 1), placed(place * a, 0, place * b, 1);
        ExpectSameMatrix(placed.At(0.4f).Matrix(), (place * motion.At(0.4f)).Matrix(), 1e-4f);
    }
}

TEST(AnimatedTransform, FlatAndMirroredOnesCannotBeInterpolated) {
    const Transform one, flat = Transform::Scale({1, 1, 0}), mirrored = Transform::Scale({1, 1, -1});
    EXPECT_TRUE(AnimatedTransform::CanInterpolate(one, Transform::Scale({-2, -1, 1})));
    EXPECT_TRUE(AnimatedTransform::CanInterpolate(mirrored, Transform::Scale({-3, 1, 1})));
    EXPECT_FALSE(AnimatedTransform::CanInterpolate(one, flat));
    EXPECT_FALSE(AnimatedTransform::CanInterpolate(flat, one));
    EXPECT_FALSE(AnimatedTransform::CanInterpolate(one, mirrored));
}

TEST(AnimatedTransform, KeepsAxesUnlessTheyTurn) {
    const Transform turned = Transform::Rotate(30, {1, 2, 3}), longer = Transform::Scale({1, 4, 2});
    EXPECT_TRUE(AnimatedTransform({}, 0, Transform::Translate({1, 2, 3}) * longer, 1).KeepsAxes());
    EXPECT_TRUE(AnimatedTransform(turned, 0, Transform::Translate({1, 2, 3}) * turned * longer, 1).KeepsAxes());
    EXPECT_FALSE(AnimatedTransform({}, 0, turned, 1).KeepsAxes());
    EXPECT_FALSE(AnimatedTransform({}, 0, turned * longer * turned.Inverse(), 1).KeepsAxes());
}

}  // namespace
}  // namespace pbrt::test
