#include <gtest/gtest.h>

#include "accel_scenes.h"
#include "pbrt/core/error.h"

namespace pbrt::test {
namespace {

/// Compares Accel with SlowIntersect on random rays; returns the number of hits.
int CompareOnRandomRays(const Accel &accel, const Shapes &shapes, const std::vector<Placement> &placements, int rays) {
    Rng rng(33);
    int hits = 0, different = 0;
    Bounds3 b = accel.Bounds();
    for (int i = 0; i < rays; ++i) {
        Ray ray;
        for (int k = 0; k < 3; ++k) {
            Float margin = 0.5f;
            ray.o[k] = Lerp(rng.Uniform() * (1 + 2 * margin) - margin, b.low[k], b.high[k]);
            ray.d[k] = Lerp(rng.Uniform(), b.low[k], b.high[k]);
        }
        ray.d = (ray.d - ray.o) * (0.1f + 2 * rng.Uniform());
        if (i % 4 == 0) ray.tMax = 0.5f;
        auto fast = accel.Intersect(ray);
        auto slow = SlowIntersect(shapes, placements, ray);
        EXPECT_EQ(fast.has_value(), accel.Occluded(ray)) << i;
        hits += fast.has_value();
        if (fast.has_value() != slow.has_value() ||
            (fast &&
             (fast->shape != slow->shape || fast->primitive != slow->primitive || fast->instance != slow->instance))) {
            ++different;  // at the edges of primitives rounding decides
            continue;
        }
        if (!fast) continue;
        // In rendering space the barycentric coordinates and t must give the same point.
        const Shape &shape = *shapes[fast->shape.value];
        Transform t = fast->instance < 0 ? Transform() : accel.InstanceTransform(fast->instance, 0);
        SurfacePoint a = TransformSurface(t, shape.Surface(fast->primitive, fast->hit));
        SurfacePoint c = TransformSurface(t, shape.Surface(slow->primitive, slow->hit));
        Float graze = std::max(Float(0.02), AbsDot(Normalize(ray.d), a.n));
        EXPECT_LT(Distance(a.p, c.p), 2e-5f / graze) << i;
        EXPECT_LT(Distance(a.p, ray(fast->hit.t)), 2e-5f / graze) << i;
        EXPECT_LT(glm::length(a.uv - c.uv), 2e-3f / graze) << i;
    }
    EXPECT_LE(different, rays / 2000 + 1);
    return hits;
}

TEST(Accel, ShadowRaysPassWhatTheyAreLetThrough) {
    Shapes shapes = EveryKind(Transform());
    const auto last = uint32_t(shapes.size() - 1);
    Accel direct, instanced;
    for (Accel *accel : {&direct, &instanced})
        for (uint32_t i = 0; i < last; ++i) accel->LetShadowRaysThrough(ShapeId(i));
    for (uint32_t i = 0; i <= last; ++i) direct.AddShape(ShapeId(i), *shapes[i], nullptr);
    instanced.AddInstance(AddObject(instanced, shapes), Transform());
    direct.Commit();
    instanced.Commit();
    Shapes blocking;
    blocking.push_back(std::move(shapes[last]));
    Rng rng(5);
    const Bounds3 b = direct.Bounds();
    std::vector<int> met(last + 1);
    for (int i = 0; i < 4000; ++i) {
        const Ray ray = RandomRay(rng, b);
        const bool blocked = SlowIntersect(blocking, {{-1, Transform()}}, ray).has_value();
        for (const Accel *accel : {&direct, &instanced}) {
            EXPECT_EQ(accel->Occluded(ray), blocked) << i;
            if (auto hit = accel->Intersect(ray)) ++met[hit->shape.value];
        }
    }
    for (int count : met) EXPECT_GT(count, 100);
}

TEST(Accel, AgreesWithTheSlowTwinForEveryKind) {
    Shapes shapes = EveryKind(Transform());
    const AccelOf accel(shapes);
    EXPECT_GT(CompareOnRandomRays(accel, shapes, {{-1, Transform()}}, 12000), 2000);
    EXPECT_GT(accel.Bytes(), 0u);
}

TEST(Accel, AgreesWithTheSlowTwinInInstances) {
    Shapes shapes = EveryKind(Transform::Rotate(20, {0, 1, 1}));
    Accel accel;
    const int object = AddObject(accel, shapes);
    std::vector<Placement> placements;
    for (const Transform &t :
         {Transform::Translate({0, 0, 5}) * Transform::Scale({0.5f, 2, 1}), Transform::Scale({-1, 1, 1}),
          Transform::Translate({3, -6, 1}) * Transform::Rotate(70, {1, 2, 3}) * Transform::Scale({1, 0.7f, -0.4f})})
        placements.push_back({accel.AddInstance(object, t), t});
    accel.Commit();
    EXPECT_EQ(accel.InstanceTransform(1, 0), placements[1].transform);
    EXPECT_GT(CompareOnRandomRays(accel, shapes, placements, 8000), 1000);
}

TEST(Accel, TracesNothingWhenEmpty) {
    Accel accel;
    accel.AddObject({}, {}, {});
    accel.AddInstance(0, Transform());
    accel.Commit();
    EXPECT_FALSE(accel.Intersect(Ray()));
    EXPECT_FALSE(accel.Occluded(Ray()));
    EXPECT_TRUE(accel.Bounds().IsEmpty());
}

TEST(Accel, BoundsHoldEverything) {
    Shapes shapes = EveryKind(Transform());
    Bounds3 expected;
    for (const auto &shape : shapes)
        for (uint32_t k = 0; k < shape->PrimitiveCount(); ++k) expected = Union(expected, shape->PrimitiveBounds(k));
    const AccelOf accel(shapes);
    Bounds3 b = accel.Bounds();
    EXPECT_TRUE(b.Contains(expected.low));
    EXPECT_TRUE(b.Contains(expected.high));
    EXPECT_LT(Distance(b.low, expected.low), 1e-4);
}

TEST(Accel, SegmentsEndBeforeTheirTarget) {
    Disk disk(0, 1, 0, 360, Transform(), false);
    const AccelOf accel(disk);
    const Vector3 up(0, 0, 1);
    EXPECT_FALSE(accel.Occluded({{0.2f, 0.1f, -2}, up, 1.9999f}));
    EXPECT_TRUE(accel.Occluded({{0.2f, 0.1f, -2}, up, 2.0001f}));
    EXPECT_FALSE(accel.Occluded({{0.2f, 0.1f, 0}, up, 2.0001f})) << "on the surface";
}

TEST(Accel, InvalidRaysHitNothingAndReachNoLight) {
    Shapes shapes = EveryKind(Transform());
    const AccelOf accel(shapes);
    constexpr Float kNan = std::numeric_limits<Float>::quiet_NaN();
    const Ray good{{0, 0, 5}, Normalize(Vector3(-2, 0, -5))};
    ASSERT_TRUE(accel.Intersect(good));
    for (Float bad : {kNan, Infinity, -Infinity, 1e30f, -2e18f})
        for (int k = 0; k < 3; ++k)
            for (const bool isOrigin : {true, false}) {
                Ray ray = good;
                (isOrigin ? ray.o : ray.d)[k] = bad;
                EXPECT_FALSE(accel.Intersect(ray)) << bad;
                EXPECT_TRUE(accel.Occluded(ray)) << bad;
            }
    for (Float end : {kNan, -1.f}) {
        Ray ray = good;
        ray.tMax = end;
        EXPECT_FALSE(accel.Intersect(ray));
    }
}

TEST(Accel, RaysStayRaysInSmallInstances) {
    Shapes shapes = EveryKind(Transform());
    auto build = [&](Float scale, Float extent) {
        auto accel = std::make_unique<Accel>();
        const int object = accel->AddObject({ShapeId(0u)}, {shapes[0].get()}, {nullptr});
        accel->AddInstance(object, Transform::Scale(Vector3(scale)));
        accel->AddInstance(object, Transform::Translate({extent, 0, 0}));
        accel->Commit();
        return accel;
    };
    // The instance space is 1e10 times larger than rendering space; Embree asserts that rays are valid there, too.
    auto accel = build(1e-10f, 1e7f);
    int hits = 0;
    for (Float far : {1e3f, 1e7f, 1e9f, 1e16f, 1e18f}) {
        const Ray ray{{-2e-10f, 0, far}, {0, 0, -1}};
        hits += accel->Intersect(ray).has_value();
        accel->Occluded(ray);
    }
    EXPECT_GE(hits, 1);
    EXPECT_THROW(build(1e-13f, 1e7f), UserError);
}

TEST(Accel, HitsOfTinyPrimitivesLieOnTheRay) {
    for (const Float size : {1e-4f, 1e-8f, 1e-10f})
        for (const auto &[name, shape] : Floors(1, Transform::Scale(Vector3(size)), 0))
            for (const bool enlarged : {false, true}) {
                const Transform place = enlarged ? Transform::Scale(Vector3(1 / size)) : Transform();
                const Float reach = enlarged ? 1 : size;
                const AccelOf accel(*shape, enlarged ? &place : nullptr);
                Rng rng(8);
                for (int i = 0; i < 200; ++i) {
                    const Point3 target = Float(0.6) * reach * Vector3(2 * rng.Uniform() - 1, 2 * rng.Uniform() - 1, 0);
                    const Point3 o = target + reach * Vector3(rng.Uniform() - 0.5f, rng.Uniform() - 0.5f, 1.5f);
                    const Ray ray{o, Normalize(target - o)};
                    const auto hit = accel.Intersect(ray);
                    ASSERT_TRUE(hit) << size << ' ' << name << ' ' << enlarged;
                    const Ray local{place.InversePoint(ray.o), place.InverseVector(ray.d)};
                    const Point3 p = place.Point(shape->SurfaceOnRay(hit->primitive, hit->hit, local).p);
                    EXPECT_LT(Distance(p, target), 1e-5f * reach) << size << ' ' << name << ' ' << enlarged;
                }
            }
}

TEST(Accel, HitsLieBehindTheOriginAndBehindTMin) {
    const Transform place = Transform::Scale({4, 4, -4});
    for (const auto &[name, shape] : Floors(1, {}, 0))
        for (const bool instanced : {false, true}) {
            const AccelOf accel(*shape, instanced ? &place : nullptr);
            Rng rng(7);
            for (int i = 0; i < 200; ++i) {
                Ray ray;
                ray.o = {0.5f * rng.Uniform(), 0.4f * rng.Uniform(), 0};
                ray.d = RandomDirection(rng);
                EXPECT_FALSE(accel.Intersect(ray)) << name << ' ' << instanced;
                EXPECT_FALSE(accel.Occluded(ray)) << name << ' ' << instanced;
                ray.o -= ray.d * (0.1f * rng.Uniform());
                const auto hit = accel.Intersect(ray);
                ASSERT_TRUE(hit && hit->hit.t > 0);
                EXPECT_FALSE(accel.Intersect(ray, hit->hit.t)) << name << ' ' << instanced;
                EXPECT_TRUE(accel.Intersect(ray, std::nextafter(hit->hit.t, 0.f) * 0.999f));
            }
        }
}

}  // namespace
}  // namespace pbrt::test
