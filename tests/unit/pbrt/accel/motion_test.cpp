#include <gtest/gtest.h>

#include "accel_scenes.h"

namespace pbrt::test {
namespace {

constexpr Float kStart = 0.5f, kEnd = 2.5f;

AnimatedTransform Between(const Transform &a, const Transform &b) { return {a, kStart, b, kEnd}; }

struct Product {
    AnimatedTransform outer, inner;
    Float tolerance;  ///< accepted error of Embree's matrices
    Transform At(Float time) const { return outer.At(time) * inner.At(time); }
};

std::vector<Product> Motions() {
    const Transform far = Transform::Translate({9, 0, 2}), turn = Transform::Rotate(170, {1, 2, 3}),
                    squeeze = Transform::Rotate(40, {0, 1, 1}) * Transform::Scale({0.5f, 2, 1}) *
                              Transform::Rotate(-40, {0, 1, 1});
    return {{Between({}, Transform::Translate({3, -1, 0.5f}) * Transform::Scale({0.5f, 1, 2})), {}, 1e-5f},
            {Between(far, far * turn), {}, 2e-5f},
            {Between(Transform::Scale({-1, 1, 1}), Transform::Translate({-8, 0, 0}) * Transform::Rotate(90, {0, 0, 1}) *
                                                       Transform::Scale({-0.7f, 1, 2})),
             {},
             2e-5f},
            {Between(Transform::Translate({0, 8, 0}), Transform::Translate({0, 9, 0}) * turn * squeeze), {}, 1e-3f},
            {Between(Transform::Translate({0, -9, 0}), Transform::Translate({0, -9, 0}) * turn),
             Between({}, Transform::Rotate(60, {0, 1, 0})), 2e-3f},
            {Transform::Translate({0, 0, 9}) * squeeze, Between({}, turn), 2e-3f}};
}

/// One object of every kind of shape: six moving instances and one at rest; and the same shapes once more outside of
/// any object.
struct World {
    Shapes shapes = EveryKind(Transform());
    std::vector<Product> motions = Motions();
    Transform still = Transform::Translate({-12, 0, 0}) * Transform::Rotate(20, {1, 1, 0});
    Accel accel;

    World() {
        const int object = AddObject(accel, shapes);
        for (const Product &m : motions) accel.AddMovingInstance(object, m.outer, m.inner);
        accel.AddInstance(object, still);
        for (size_t i = 0; i < shapes.size(); ++i) accel.AddShape(ShapeId(i), *shapes[i], nullptr);
        accel.Commit();
    }
    std::vector<Placement> At(Float time) const {
        std::vector<Placement> placements = {{-1, Transform()}};
        for (int i = 0; i <= int(motions.size()); ++i) placements.push_back({i, accel.InstanceTransform(i, time)});
        return placements;
    }
};

TEST(Motion, EmbreeInterpolatesAsWeDo) {
    const World world;
    for (size_t i = 0; i < world.motions.size(); ++i)
        for (Float time : {0.0f, 0.5f, 0.53f, 1.1f, 1.5f, 1.99f, 2.47f, 2.5f, 7.0f}) {
            const glm::mat4 a = world.accel.InstanceTransform(int(i), time).Matrix();
            const glm::mat4 b = world.motions[i].At(time).Matrix();
            for (int c = 0; c < 4; ++c)
                for (int r = 0; r < 4; ++r)
                    EXPECT_NEAR(a[c][r], b[c][r], world.motions[i].tolerance) << i << " at " << time;
        }
    EXPECT_EQ(world.accel.InstanceTransform(int(world.motions.size()), 1), world.still);
}

/// The reference uses Embree's transforms, which are close to ours by the test above.
TEST(Motion, AgreesWithTheSlowTwinAtEveryTime) {
    const World world;
    const Bounds3 b = world.accel.Bounds();
    Rng rng(5);
    int hits = 0, moving = 0, different = 0;
    constexpr int kRays = 12000;
    for (int i = 0; i < kRays; ++i) {
        Ray ray;
        ray.time = 3 * rng.Uniform();
        const std::vector<Placement> placements = world.At(ray.time);
        // The ray is aimed at a point near one of the placements.
        const Placement &target = placements[size_t(i) % placements.size()];
        ray.o = target.transform.Point(6.0f * RandomDirection(rng));
        ray.d = target.transform.Point(2.0f * RandomDirection(rng)) - ray.o;
        if (i % 4 == 0) ray.tMax = 0.8f;
        auto fast = world.accel.Intersect(ray), slow = SlowIntersect(world.shapes, placements, ray);
        EXPECT_EQ(fast.has_value(), world.accel.Occluded(ray)) << i;
        if (fast.has_value() != slow.has_value() ||
            (fast && (fast->shape != slow->shape || fast->instance != slow->instance))) {
            ++different;
            continue;
        }
        if (!fast) continue;
        ++hits;
        moving += fast->instance >= 0 && fast->instance < int(world.motions.size());
        const Shape &shape = *world.shapes[fast->shape.value];
        SurfacePoint s = shape.Surface(fast->primitive, fast->hit);
        if (fast->instance >= 0) s = TransformSurface(world.accel.InstanceTransform(fast->instance, ray.time), s);
        const Float graze = std::max(Float(0.02), AbsDot(Normalize(ray.d), s.n));
        EXPECT_LT(Distance(s.p, ray(fast->hit.t)), 3e-5f / graze) << i;
        EXPECT_LT(Distance(ray(slow->hit.t), ray(fast->hit.t)), 3e-5f / graze) << i;
        for (int a = 0; a < 3; ++a) EXPECT_TRUE(s.p[a] > b.low[a] - 1e-4f && s.p[a] < b.high[a] + 1e-4f) << i;
    }
    EXPECT_GT(hits, kRays / 4);
    EXPECT_GT(moving, kRays / 5);
    EXPECT_LT(different, kRays / 100) << "of " << hits;
}

TEST(Motion, JumpsIfBothTimesAreTheSame) {
    const Sphere ball(1, -1, 1, 360, Transform(), false);
    Accel accel;
    const int object = accel.AddObject({ShapeId(0u)}, {&ball}, {nullptr});
    accel.AddMovingInstance(object, AnimatedTransform({}, 1, Transform::Translate({9, 0, 0}), 1));
    accel.Commit();
    for (Float time : {0.0f, 1.0f, 1.1f})
        EXPECT_TRUE(accel.Occluded({{time > 1 ? 9.0f : 0.0f, 0, -5}, {0, 0, 1}, Infinity, time})) << time;
}

TEST(Motion, BoundsHoldTheWholeWay) {
    const Sphere ball(1, -1, 1, 360, Transform(), false);
    Accel accel;
    const int object = accel.AddObject({ShapeId(0u)}, {&ball}, {nullptr});
    accel.AddMovingInstance(object, Between(Transform::Translate({-3, 0, 0}), Transform::Translate({5, 0, 0})));
    const AnimatedTransform swing =
        Between(Transform::Translate({0, 0, 2}), Transform::Rotate(179, {1, 0, 0}) * Transform::Scale(Vector3(1)));
    const AnimatedTransform lever = Transform::Translate({0, 6, 0});
    accel.AddMovingInstance(object, swing, lever);
    accel.Commit();
    const Bounds3 b = accel.Bounds();
    Bounds3 needed;
    for (int i = 0; i <= 100; ++i) {
        const Float time = Lerp(Float(i) / 100, kStart, kEnd);
        for (int axis = 0; axis < 3; ++axis)
            for (Float sign : {-1.0f, 1.0f}) {
                Point3 rim(0);
                rim[axis] = sign;
                needed = Union(needed, (swing.At(time) * lever.At(time)).Point(rim));
            }
    }
    needed = Union(Union(needed, Point3(-4, 0, 0)), Point3(6, 0, 0));
    for (int a = 0; a < 3; ++a) {
        EXPECT_LE(b.low[a], needed.low[a] + 1e-5f);
        EXPECT_GE(b.high[a], needed.high[a] - 1e-5f);
        EXPECT_GT(b.low[a], needed.low[a] - 4) << "the bounds of the motion are too wide";
        EXPECT_LT(b.high[a], needed.high[a] + 4);
    }
}

}  // namespace
}  // namespace pbrt::test
