#pragma once
#include <memory>
#include <vector>

#include "pbrt/accel/accel.h"
#include "pbrt/shapes/bilinear_mesh.h"
#include "pbrt/shapes/quadric.h"
#include "pbrt/shapes/triangle_mesh.h"
#include "support/sampling.h"

namespace pbrt::test {

/// A closed, bumpy ball of 2 n (n - 1) triangles, radius about 1.
inline MeshData BumpyBall(uint32_t n, uint64_t seed = 1) {
    Rng rng(seed);
    MeshData mesh;
    uint32_t around = n, rings = n - 1;
    mesh.p.push_back({0, 0, 1});
    for (uint32_t r = 1; r <= rings; ++r)
        for (uint32_t a = 0; a < around; ++a) {
            Float theta = Pi * Float(r) / Float(n);
            Float phi = 2 * Pi * Float(a) / Float(around);
            Float radius = 1 + 0.3f / Float(n) * (rng.Uniform() - 0.5f);
            mesh.p.push_back(radius * SphericalDirection(std::sin(theta), std::cos(theta), phi));
        }
    mesh.p.push_back({0, 0, -1});
    auto at = [&](uint32_t r, uint32_t a) { return 1 + (r - 1) * around + a % around; };
    auto last = uint32_t(mesh.p.size() - 1);
    for (uint32_t a = 0; a < around; ++a) {
        mesh.indices.insert(mesh.indices.end(), {0, at(1, a), at(1, a + 1)});
        for (uint32_t r = 1; r < rings; ++r) {
            mesh.indices.insert(mesh.indices.end(), {at(r, a), at(r + 1, a), at(r + 1, a + 1)});
            mesh.indices.insert(mesh.indices.end(), {at(r, a), at(r + 1, a + 1), at(r, a + 1)});
        }
        mesh.indices.insert(mesh.indices.end(), {at(rings, a), last, at(rings, a + 1)});
    }
    return mesh;
}

/// n x n patches over the unit square; curved ones if `bumps` is not 0.
inline MeshData PatchGrid(uint32_t n, Float bumps) {
    Rng rng(2);
    MeshData mesh;
    for (uint32_t y = 0; y <= n; ++y)
        for (uint32_t x = 0; x <= n; ++x)
            mesh.p.push_back({Float(x) / Float(n), Float(y) / Float(n), bumps * (rng.Uniform() - 0.5f)});
    for (uint32_t y = 0; y < n; ++y)
        for (uint32_t x = 0; x < n; ++x) {
            uint32_t i = y * (n + 1) + x;
            mesh.indices.insert(mesh.indices.end(), {i, i + 1, i + n + 1, i + n + 2});
        }
    return mesh;
}

using Shapes = std::vector<std::unique_ptr<Shape>>;

/// One shape of every kind that Accel treats differently.
inline Shapes EveryKind(const Transform &t) {
    Shapes s;
    auto at = [&](Float x, Float y) {
        return t * Transform::Translate({x, y, 0}) * Transform::Rotate(50, {1, 1, 0.3f});
    };
    s.push_back(std::make_unique<TriangleMesh>(BumpyBall(8), at(-2, 0), false));
    s.push_back(std::make_unique<BilinearMesh>(PatchGrid(4, 0), at(0, 0), false));
    s.push_back(std::make_unique<BilinearMesh>(PatchGrid(4, 0.3f), at(2, 0), false));
    s.push_back(std::make_unique<Sphere>(0.8f, -0.5f, 1.0f, 300.0f, at(-2, 2), false));
    s.push_back(std::make_unique<Disk>(0.1f, 0.9f, 0.2f, 320.0f, at(0, 2), false));
    s.push_back(std::make_unique<Cylinder>(0.5f, -0.6f, 0.8f, 280.0f, at(2, 2), false));
    return s;
}

struct Placement {
    int32_t instance;
    Transform transform;
};

/// The nearest hit, found by testing every primitive of every placement, in double precision where Shape::Intersect
/// uses it.
inline std::optional<AccelHit> SlowIntersect(const Shapes &shapes, const std::vector<Placement> &placements,
                                             const Ray &ray) {
    std::optional<AccelHit> best;
    Float tMax = ray.tMax;
    for (const Placement &p : placements) {
        Point3 o = p.transform.InversePoint(ray.o);
        Vector3 d = p.transform.InverseVector(ray.d);
        for (size_t s = 0; s < shapes.size(); ++s)
            for (uint32_t i = 0; i < shapes[s]->PrimitiveCount(); ++i)
                if (auto hit = shapes[s]->Intersect(i, {o, d, tMax}, 0)) {
                    best = AccelHit{ShapeId(s), i, *hit, p.instance};
                    tMax = hit->t;
                }
    }
    return best;
}

}  // namespace pbrt::test
