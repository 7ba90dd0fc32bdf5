// Single-thread ray queries on a wrinkled ball of about 500,000 triangles: the cost of robust traversal,
// of instances and of alpha. items_per_second is rays per second.
#include <benchmark/benchmark.h>

#include <map>

#include "pbrt/accel/accel.h"
#include "pbrt/math/rng.h"
#include "pbrt/shapes/triangle_mesh.h"

namespace pbrt {
namespace {

constexpr uint32_t kRings = 500;

/// 2 * kRings * kRings triangles, radius about 1, wrinkled so that rays graze many of them.
MeshData WrinkledBall() {
    MeshData mesh;
    for (uint32_t r = 0; r <= kRings; ++r)
        for (uint32_t a = 0; a < kRings; ++a) {
            Float theta = Pi * (0.001f + 0.998f * Float(r) / kRings);
            Float phi = 2 * Pi * Float(a) / kRings;
            Float radius = 1 + 0.08f * std::sin(23 * theta) * std::sin(17 * phi);
            mesh.p.push_back(radius * SphericalDirection(std::sin(theta), std::cos(theta), phi));
        }
    for (uint32_t r = 0; r < kRings; ++r)
        for (uint32_t a = 0; a < kRings; ++a) {
            uint32_t b = (a + 1) % kRings, i = r * kRings, j = i + kRings;
            mesh.indices.insert(mesh.indices.end(), {i + a, j + a, j + b, i + a, j + b, i + b});
        }
    return mesh;
}

class HalfAlpha final : public FloatTexture {
  public:
    Float Evaluate(const TextureContext &) const override { return 0.5f; }
};

enum class Variant { Robust, Fast, Instance, Alpha };

struct Scene {
    TriangleMesh mesh{WrinkledBall(), Transform(), false};
    HalfAlpha half;
    std::map<Variant, std::unique_ptr<Accel>> accels;

    static Scene &Get() {
        static Scene scene;
        return scene;
    }
    const Accel &Of(Variant v) {
        std::unique_ptr<Accel> &accel = accels[v];
        if (accel) return *accel;
        accel = std::make_unique<Accel>(v != Variant::Fast);
        if (v == Variant::Instance)
            accel->AddInstance(accel->AddObject({ShapeId(0u)}, {&mesh}, {nullptr}), Transform());
        else accel->AddShape(ShapeId(0u), mesh, v == Variant::Alpha ? &half : nullptr);
        accel->Commit();
        return *accel;
    }
};

/// Camera: neighbouring rays are similar. Bounce: rays from surface points in all outward directions, as in a path
/// tracer.
std::vector<Ray> CameraRays() {
    std::vector<Ray> rays;
    constexpr int n = 256;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            Ray r;
            r.o = {0, 0, -3};
            r.d = Normalize(Vector3((Float(x) / n - 0.5f) * 0.8f, (Float(y) / n - 0.5f) * 0.8f, 1));
            rays.push_back(r);
        }
    return rays;
}

std::vector<Ray> BounceRays() {
    Scene &scene = Scene::Get();
    std::vector<Ray> rays;
    Rng rng(1);
    while (rays.size() < 65536) {
        // From inside, so that every ray has something to hit.
        auto primitive = rng.UniformInt(scene.mesh.PrimitiveCount());
        SurfacePoint s = scene.mesh.Surface(primitive, {1, 0.3f, 0.3f});
        Float z = 2 * rng.Uniform() - 1;
        Vector3 d = SphericalDirection(SafeSqrt(1 - z * z), z, 2 * Pi * rng.Uniform());
        rays.push_back(s.SpawnRay(FaceForward(d, -s.p)));
    }
    return rays;
}

void ClosestHit(benchmark::State &state, Variant variant, bool bounce) {
    const Accel &accel = Scene::Get().Of(variant);
    std::vector<Ray> rays = bounce ? BounceRays() : CameraRays();
    for (auto _ : state)
        for (const Ray &ray : rays) benchmark::DoNotOptimize(accel.Intersect(ray));
    state.SetItemsProcessed(state.iterations() * int64_t(rays.size()));
}

void Occlusion(benchmark::State &state, Variant variant) {
    const Accel &accel = Scene::Get().Of(variant);
    std::vector<Ray> rays = BounceRays();
    for (Ray &ray : rays) ray.tMax = 1;  // about half are blocked
    for (auto _ : state)
        for (const Ray &ray : rays) benchmark::DoNotOptimize(accel.Occluded(ray));
    state.SetItemsProcessed(state.iterations() * int64_t(rays.size()));
}

void Build(benchmark::State &state, Variant variant) {
    Scene &scene = Scene::Get();
    for (auto _ : state) {
        scene.accels.erase(variant);
        benchmark::DoNotOptimize(&scene.Of(variant));
    }
    state.counters["bytes_per_triangle"] = double(scene.Of(variant).Bytes()) / double(scene.mesh.PrimitiveCount());
}

BENCHMARK_CAPTURE(Build, robust, Variant::Robust)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Build, fast, Variant::Fast)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ClosestHit, camera_robust, Variant::Robust, false);
BENCHMARK_CAPTURE(ClosestHit, camera_fast, Variant::Fast, false);
BENCHMARK_CAPTURE(ClosestHit, bounce_robust, Variant::Robust, true);
BENCHMARK_CAPTURE(ClosestHit, bounce_fast, Variant::Fast, true);
BENCHMARK_CAPTURE(ClosestHit, bounce_instance, Variant::Instance, true);
BENCHMARK_CAPTURE(ClosestHit, bounce_alpha_half, Variant::Alpha, true);
BENCHMARK_CAPTURE(Occlusion, bounce_robust, Variant::Robust);
BENCHMARK_CAPTURE(Occlusion, bounce_fast, Variant::Fast);

}  // namespace
}  // namespace pbrt

BENCHMARK_MAIN();
