#include "pbrt/accel/accel.h"

#include <gtest/gtest.h>

#include "accel_scenes.h"
#include "pbrt/core/error.h"

namespace pbrt {
namespace {

using test::Placement;
using test::Shapes;
using test::SlowIntersect;

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
    Shapes shapes = test::EveryKind(Transform());
    const auto last = uint32_t(shapes.size() - 1);
    Accel direct, instanced;
    std::vector<ShapeId> ids;
    std::vector<const Shape *> pointers;
    for (uint32_t i = 0; i <= last; ++i) {
        for (Accel *a : {&direct, &instanced})
            if (i != last) a->LetShadowRaysThrough(ShapeId(i));
        ids.emplace_back(i);
        pointers.push_back(shapes[i].get());
        direct.AddShape(ids[i], *pointers[i], nullptr);
    }
    const int object = instanced.AddObject(ids, pointers, std::vector<const FloatTexture *>(ids.size()));
    instanced.AddInstance(object, Transform());
    const Accel *accels[] = {&direct, &instanced};
    direct.Commit();
    instanced.Commit();
    Shapes blocking;
    blocking.push_back(std::move(shapes[last]));
    Rng rng(5);
    const Bounds3 b = direct.Bounds();
    std::vector<int> met(last + 1);
    for (int i = 0; i < 4000; ++i) {
        Ray ray;
        for (int k = 0; k < 3; ++k) ray.o[k] = Lerp(2 * rng.Uniform() - .5f, b.low[k], b.high[k]);
        for (int k = 0; k < 3; ++k) ray.d[k] = Lerp(rng.Uniform(), b.low[k], b.high[k]) - ray.o[k];
        const bool blocked = test::SlowIntersect(blocking, {{-1, Transform()}}, ray).has_value();
        for (const Accel *accel : accels) {
            EXPECT_EQ(accel->Occluded(ray), blocked) << i;
            if (auto hit = accel->Intersect(ray)) ++met[hit->shape.value];
        }
    }
    for (int count : met) EXPECT_GT(count, 100);
}

TEST(Accel, AgreesWithTheSlowTwinForEveryKind) {
    Shapes shapes = test::EveryKind(Transform());
    Accel accel;
    for (size_t i = 0; i < shapes.size(); ++i) accel.AddShape(ShapeId(i), *shapes[i], nullptr);
    accel.Commit();
    EXPECT_GT(CompareOnRandomRays(accel, shapes, {{-1, Transform()}}, 12000), 2000);
    EXPECT_GT(accel.Bytes(), 0u);
}

TEST(Accel, AgreesWithTheSlowTwinInInstances) {
    Shapes shapes = test::EveryKind(Transform::Rotate(20, {0, 1, 1}));
    Accel accel;
    std::vector<ShapeId> ids;
    std::vector<const Shape *> pointers;
    for (size_t i = 0; i < shapes.size(); ++i) {
        ids.emplace_back(i);
        pointers.push_back(shapes[i].get());
    }
    int object = accel.AddObject(ids, pointers, std::vector<const FloatTexture *>(ids.size(), nullptr));
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
    Ray ray;
    EXPECT_FALSE(accel.Intersect(ray));
    EXPECT_FALSE(accel.Occluded(ray));
    EXPECT_TRUE(accel.Bounds().IsEmpty());
}

TEST(Accel, BoundsHoldEverything) {
    Shapes shapes = test::EveryKind(Transform());
    Accel accel;
    Bounds3 expected;
    for (size_t i = 0; i < shapes.size(); ++i) {
        accel.AddShape(ShapeId(i), *shapes[i], nullptr);
        for (uint32_t k = 0; k < shapes[i]->PrimitiveCount(); ++k)
            expected = Union(expected, shapes[i]->PrimitiveBounds(k));
    }
    accel.Commit();
    Bounds3 b = accel.Bounds();
    EXPECT_TRUE(b.Contains(expected.low));
    EXPECT_TRUE(b.Contains(expected.high));
    EXPECT_LT(Distance(b.low, expected.low), 1e-4);
}

TEST(Accel, SegmentsEndBeforeTheirTarget) {
    Disk disk(0, 1, 0, 360, Transform(), false);
    Accel accel;
    accel.AddShape(ShapeId(0u), disk, nullptr);
    accel.Commit();
    Ray ray;
    ray.o = {0.2f, 0.1f, -2};
    ray.d = {0, 0, 1};
    ray.tMax = 1.9999f;
    EXPECT_FALSE(accel.Occluded(ray));
    ray.tMax = 2.0001f;
    EXPECT_TRUE(accel.Occluded(ray));
    ray.o.z = 0;  // on the surface
    EXPECT_FALSE(accel.Occluded(ray));
}

TEST(Accel, WhatIsNoRayHitsNothingAndSeesNoLight) {
    Shapes shapes = test::EveryKind(Transform());
    Accel accel;
    for (size_t i = 0; i < shapes.size(); ++i) accel.AddShape(ShapeId(i), *shapes[i], nullptr);
    accel.Commit();
    constexpr Float kNan = std::numeric_limits<Float>::quiet_NaN();
    Ray good;
    good.o = {0, 0, 5};
    good.d = Normalize(Vector3(-2, 0, -5));
    ASSERT_TRUE(accel.Intersect(good));
    for (Float bad : {kNan, Infinity, -Infinity, 1e30f, -2e18f})
        for (int k = 0; k < 3; ++k) {
            Ray ray = good;
            ray.o[k] = bad;
            EXPECT_FALSE(accel.Intersect(ray)) << bad;
            EXPECT_TRUE(accel.Occluded(ray)) << bad;
            ray = good;
            ray.d[k] = bad;
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
    Shapes shapes = test::EveryKind(Transform());
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
        Ray ray;
        ray.o = {-2e-10f, 0, far};
        ray.d = {0, 0, -1};
        hits += accel->Intersect(ray).has_value();
        accel->Occluded(ray);
    }
    EXPECT_GE(hits, 1);
    EXPECT_THROW(build(1e-13f, 1e7f), UserError);
}

/// Flat shapes in the plane z = 0, which Embree traces and which it does not.
Shapes FlatShapes(const Transform &place = {}) {
    MeshData square;
    square.p = {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}};
    square.indices = {0, 1, 2, 1, 3, 2};
    Shapes s;
    s.push_back(std::make_unique<TriangleMesh>(square, place, false));
    square.indices = {0, 1, 2, 3};
    s.push_back(std::make_unique<BilinearMesh>(square, place, false));
    square.p[3].x = 1.5f;  // no parallelogram
    s.push_back(std::make_unique<BilinearMesh>(square, place, false));
    s.push_back(std::make_unique<Disk>(0.f, 1.f, 0.f, 360.f, place, false));
    return s;
}

TEST(Accel, HitsOfTinyPrimitivesLieOnTheRay) {
    for (const Float size : {1e-4f, 1e-8f, 1e-10f})
        for (const auto &shape : FlatShapes(Transform::Scale(Vector3(size))))
            for (const bool enlarged : {false, true}) {
                const Transform place = enlarged ? Transform::Scale(Vector3(1 / size)) : Transform();
                const Float reach = enlarged ? 1 : size;
                Accel accel;
                if (enlarged) accel.AddInstance(accel.AddObject({ShapeId(0u)}, {shape.get()}, {nullptr}), place);
                else accel.AddShape(ShapeId(0u), *shape, nullptr);
                accel.Commit();
                Rng rng(8);
                for (int i = 0; i < 200; ++i) {
                    const Point3 target = Float(0.6) * reach * Vector3(2 * rng.Uniform() - 1, 2 * rng.Uniform() - 1, 0);
                    Ray ray;
                    ray.o = target + reach * Vector3(rng.Uniform() - 0.5f, rng.Uniform() - 0.5f, 1.5f);
                    ray.d = Normalize(target - ray.o);
                    const auto hit = accel.Intersect(ray);
                    ASSERT_TRUE(hit) << size << ' ' << int(shape->Kind()) << ' ' << enlarged;
                    const Ray local{place.InversePoint(ray.o), place.InverseVector(ray.d)};
                    const Point3 p = place.Point(shape->SurfaceOnRay(hit->primitive, hit->hit, local).p);
                    EXPECT_LT(Distance(p, target), 1e-5f * reach)
                        << size << ' ' << int(shape->Kind()) << ' ' << enlarged;
                }
            }
}

TEST(Accel, HitsLieBehindTheOriginAndBehindTMin) {
    const Shapes shapes = FlatShapes();
    for (const auto &shape : shapes)
        for (const bool instanced : {false, true}) {
            Accel accel;
            if (instanced)
                accel.AddInstance(accel.AddObject({ShapeId(0u)}, {shape.get()}, {nullptr}),
                                  Transform::Scale({4, 4, -4}));
            else accel.AddShape(ShapeId(0u), *shape, nullptr);
            accel.Commit();
            Rng rng(7);
            for (int i = 0; i < 200; ++i) {
                Ray ray;
                ray.o = {0.5f * rng.Uniform(), 0.4f * rng.Uniform(), 0};
                ray.d = test::RandomDirection(rng);
                EXPECT_FALSE(accel.Intersect(ray)) << int(shape->Kind()) << ' ' << instanced;
                EXPECT_FALSE(accel.Occluded(ray)) << int(shape->Kind()) << ' ' << instanced;
                ray.o -= ray.d * (0.1f * rng.Uniform());
                const auto hit = accel.Intersect(ray);
                ASSERT_TRUE(hit && hit->hit.t > 0);
                EXPECT_FALSE(accel.Intersect(ray, hit->hit.t)) << int(shape->Kind()) << ' ' << instanced;
                EXPECT_TRUE(accel.Intersect(ray, std::nextafter(hit->hit.t, 0.f) * 0.999f));
            }
        }
}

}  // namespace
}  // namespace pbrt
