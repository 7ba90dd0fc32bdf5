// Where shadow rays pass the surfaces that let them through.
#include <gtest/gtest.h>

#include "accel_scenes.h"

namespace pbrt::test {
namespace {

/// Nested shapes of every kind, some of them half transparent, once in the scene and more often in instances.
struct NestedShapes {
    Shapes shapes = EveryKind(Transform());
    const ConstantAlpha half{.5f};
    Accel accel;
    NestedShapes() {
        std::vector<const FloatTexture *> alphas;
        for (uint32_t i = 0; i < shapes.size(); ++i) {
            alphas.push_back(i % 3 == 1 ? &half : nullptr);
            accel.LetShadowRaysThrough(ShapeId(i), true);
            accel.AddShape(ShapeId(i), *shapes[i], alphas[i]);
        }
        const int object = AddObject(accel, shapes, alphas);
        for (int i = 0; i < 20; ++i)
            accel.AddInstance(object,
                              Transform::Rotate(Float(18 * i), {1, 2, 3}) * Transform::Scale({1.2f, .9f, 1.1f}));
        accel.Commit();
    }
};

TEST(PassedHits, ShadowRaysListTheHitsOfSuccessiveClosestHits) {
    const NestedShapes scene;
    Rng rng(9);
    const Bounds3 b = scene.accel.Bounds();
    int listed = 0, overflows = 0, different = 0;
    for (int i = 0; i < 8000; ++i) {
        Ray ray = RandomRay(rng, b);
        ray.d *= 2;
        PassedHits passed;
        ASSERT_FALSE(scene.accel.Occluded(ray, &passed));
        Float tMin = 0;
        for (const AccelHit &hit : passed.Hits()) {
            const auto next = scene.accel.Intersect(ray, std::nextafter(tMin, Infinity));
            ASSERT_TRUE(next);
            EXPECT_EQ(next->hit.t, hit.hit.t) << i;
            different += next->shape != hit.shape || next->primitive != hit.primitive || next->instance != hit.instance;
            tMin = hit.hit.t;
            ++listed;
        }
        EXPECT_EQ(scene.accel.Intersect(ray, std::nextafter(tMin, Infinity)).has_value(), passed.HasDropped()) << i;
        overflows += passed.HasDropped();
    }
    EXPECT_LE(different, listed / 1000);  // surfaces at the same distance
    EXPECT_GT(listed, 8000);
    EXPECT_GT(overflows, 100);
}

TEST(PassedHits, KeepsTheNearestInAnyOrderAndOneAtADistance) {
    Rng rng(4);
    for (int count = 0; count < 20; ++count)
        for (int repeat = 0; repeat < 20; ++repeat) {
            std::vector<AccelHit> hits;
            for (int i = 0; i < count; ++i)
                for (uint32_t copy = 0; copy < 2; ++copy) hits.push_back({ShapeId(copy), 7, {Float(i + 1), 0, 0}, -1});
            for (size_t i = 0; i < hits.size(); ++i)
                std::swap(hits[i], hits[size_t(rng.Uniform() * Float(hits.size()))]);
            PassedHits passed;
            for (const AccelHit &hit : hits) passed.Add(hit);
            ASSERT_EQ(passed.Hits().size(), size_t(std::min(count, PassedHits::kMaxHits)));
            EXPECT_EQ(passed.HasDropped(), count > PassedHits::kMaxHits);
            for (size_t i = 0; i < passed.Hits().size(); ++i) {
                EXPECT_EQ(passed.Hits()[i].hit.t, Float(i + 1));
                EXPECT_EQ(passed.Hits()[i].shape, ShapeId(0u));
            }
        }
}

}  // namespace
}  // namespace pbrt::test
