#include <gtest/gtest.h>

#include "accel_scenes.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

/// An alpha of 1 where u < 1/2, else 0.
class HalfAlpha final : public FloatTexture {
  public:
    Float Evaluate(const TextureContext &at) const override { return at.uv.x < 0.5f ? Float(1) : Float(0); }
};

MeshData UnitSquare(Float z, bool patch) {
    MeshData m;
    m.p = {{0, 0, z}, {1, 0, z}, {0, 1, z}, {1, 1, z}};
    m.uv = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    if (patch) m.indices = {0, 1, 2, 3};
    else m.indices = {0, 1, 3, 0, 3, 2};
    return m;
}

Ray Down(Rng &rng) { return {{rng.Uniform(), rng.Uniform(), 5}, {0, 0, -1}}; }

TEST(Alpha, ShareOfHitsIsAlphaForEveryKind) {
    Shapes shapes;
    shapes.push_back(std::make_unique<TriangleMesh>(UnitSquare(0, false), Transform(), false));
    shapes.push_back(std::make_unique<BilinearMesh>(UnitSquare(0, true), Transform(), false));
    MeshData bent = UnitSquare(0, true);
    bent.p[3].z = 0.3f;
    shapes.push_back(std::make_unique<BilinearMesh>(bent, Transform(), false));
    shapes.push_back(std::make_unique<Disk>(0.0f, 2.0f, 0.0f, 360.0f, Transform(), false));
    for (Float alpha : {0.1f, 0.5f, 0.9f})
        for (bool admit : {true, false})
            for (const auto &shape : shapes) {
                ConstantAlpha texture(alpha, admit);
                const AccelOf accel(*shape, &texture);
                Rng rng(4);
                constexpr int kRays = 20000;
                int hits = 0;
                for (int i = 0; i < kRays; ++i) {
                    Ray ray = Down(rng);
                    bool hit = accel.Intersect(ray).has_value();
                    hits += hit;
                    ASSERT_EQ(hit, accel.Occluded(ray));
                }
                double z = (hits - kRays * double(alpha)) / std::sqrt(kRays * double(alpha * (1 - alpha)));
                EXPECT_GT(NormalTail(z), SidakAlpha(1e-3, 24)) << alpha;
            }
}

TEST(Alpha, LayersAlongOneRayAreIndependent) {
    // Stacked squares, and the two sides of a sphere: k layers stop a ray with probability 1 - (1 - alpha)^k.
    ConstantAlpha texture(0.3f);
    std::vector<std::unique_ptr<TriangleMesh>> layers;
    Accel stack;
    for (uint32_t i = 0; i < 3; ++i) {
        layers.push_back(std::make_unique<TriangleMesh>(UnitSquare(Float(i), false), Transform(), false));
        stack.AddShape(ShapeId(i), *layers[i], &texture);
    }
    stack.Commit();
    Sphere sphere(3, -3, 3, 360, Transform(), false);
    const AccelOf ball(sphere, &texture);
    // The same object in three instances.
    Accel instanced;
    int object = instanced.AddObject({ShapeId(0u)}, {layers[0].get()}, {&texture});
    for (int i = 0; i < 3; ++i) instanced.AddInstance(object, Transform::Translate({0, 0, Float(i)}));
    instanced.Commit();
    for (const auto &[accel, count] : {std::pair<const Accel *, int>(&stack, 3), {&ball, 2}, {&instanced, 3}}) {
        Rng rng(5);
        constexpr int kRays = 40000;
        int hits = 0;
        for (int i = 0; i < kRays; ++i) hits += accel->Occluded(Down(rng));
        double p = 1 - std::pow(0.7, count), z = (hits - kRays * p) / std::sqrt(kRays * p * (1 - p));
        EXPECT_GT(NormalTail(z), SidakAlpha(1e-3, 3));
    }
}

TEST(Alpha, TextureIsReadAtTheHit) {
    HalfAlpha texture;
    for (const Float size : {1.f, 1e-10f})
        for (bool patch : {false, true}) {
            const Transform place = Transform::Scale(Vector3(size));
            std::unique_ptr<Shape> shape;
            if (patch) shape = std::make_unique<BilinearMesh>(UnitSquare(0, true), place, false);
            else shape = std::make_unique<TriangleMesh>(UnitSquare(0, false), place, false);
            const AccelOf accel(*shape, &texture);
            Rng rng(6);
            for (int i = 0; i < 2000; ++i) {
                Ray ray = Down(rng);
                const Float x = ray.o.x;
                if (std::abs(x - 0.5f) < 1e-4f) continue;
                ray.o *= size;
                EXPECT_EQ(accel.Occluded(ray), x < 0.5f);
            }
        }
}

TEST(Alpha, RaysHitTheFartherSurfaceThroughAHole) {
    HalfAlpha texture;
    Sphere sphere(1, -1, 1, 360, Transform(), false);  // the half u < 1/2 is y > 0
    const AccelOf accel(sphere, &texture);
    Ray ray{{0, -5, 0}, {0, 1, 0}};
    auto hit = accel.Intersect(ray);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->hit.t, 6, 1e-5);
    ray.tMax = 5.5f;
    EXPECT_FALSE(accel.Occluded(ray));
}

TEST(Alpha, ConstantZeroIsNotTracedAndOneIsOpaque) {
    ConstantAlpha zero(0), one(1);
    TriangleMesh mesh(UnitSquare(0, false), Transform(), false);
    const AccelOf none(mesh, &zero), all(mesh, &one);
    EXPECT_TRUE(none.Bounds().IsEmpty());
    Rng rng(7);
    for (int i = 0; i < 200; ++i) {
        Ray ray = Down(rng);
        EXPECT_FALSE(none.Intersect(ray));
        EXPECT_TRUE(all.Occluded(ray));
    }
}

}  // namespace
}  // namespace pbrt::test
