#pragma once
#include <memory>

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

/// Floors of the half width r at z = `level`. The triangles and the patches of the grid meet below the origin.
struct Floor {
    const char *name;
    std::unique_ptr<Shape> shape;
};
inline std::vector<Floor> Floors(Float r, const Transform &t, Float level) {
    MeshData square;
    square.p = {{-r, -r, level}, {r, -r, level}, {-r, r, level}, {r, r, level}};
    square.indices = {0, 1, 2, 1, 3, 2};
    std::vector<Floor> floors;
    floors.push_back({"triangles", std::make_unique<TriangleMesh>(square, t, false)});
    square.indices = {0, 1, 2, 3};
    floors.push_back({"patch", std::make_unique<BilinearMesh>(square, t, false)});
    MeshData grid = PatchGrid(2, 0);
    for (Point3 &p : grid.p) p = {(2 * p.x - 1) * r, (2 * p.y - 1) * r, level};
    floors.push_back({"grid", std::make_unique<BilinearMesh>(grid, t, false)});
    square.p[3].x *= 1.5f;
    floors.push_back({"trapezoid", std::make_unique<BilinearMesh>(square, t, false)});
    floors.push_back({"disk", std::make_unique<Disk>(level, r, 0.f, 360.f, t, false)});
    return floors;
}

class ConstantAlpha final : public FloatTexture {
  public:
    explicit ConstantAlpha(Float v, bool admit = true) : value_(v), admit_(admit) {}
    Float Evaluate(const TextureContext &) const override { return value_; }
    std::optional<Float> Constant() const override { return admit_ ? std::optional<Float>(value_) : std::nullopt; }

  private:
    Float value_;
    bool admit_;  ///< whether Constant() returns the value
};

/// Adds an object of all shapes.
inline int AddObject(Accel &accel, const Shapes &shapes, std::vector<const FloatTexture *> alphas = {}) {
    std::vector<ShapeId> ids;
    std::vector<const Shape *> pointers;
    for (const auto &shape : shapes) {
        ids.emplace_back(ids.size());
        pointers.push_back(shape.get());
    }
    alphas.resize(shapes.size());
    return accel.AddObject(ids, pointers, alphas);
}

/// Ready to trace.
struct AccelOf : Accel {
    explicit AccelOf(const Shapes &shapes) {
        for (size_t i = 0; i < shapes.size(); ++i) AddShape(ShapeId(i), *shapes[i], nullptr);
        Commit();
    }
    explicit AccelOf(const Shape &shape, const FloatTexture *alpha = nullptr) {
        AddShape(ShapeId(0u), shape, alpha);
        Commit();
    }
    /// An instance of the shape if `place` is not null.
    AccelOf(const Shape &shape, const Transform *place) {
        if (place) AddInstance(AddObject({ShapeId(0u)}, {&shape}, {nullptr}), *place);
        else AddShape(ShapeId(0u), shape, nullptr);
        Commit();
    }
};

/// From around the bounds to a point within them at t = 1.
inline Ray RandomRay(Rng &rng, const Bounds3 &b) {
    Ray ray;
    for (int k = 0; k < 3; ++k) ray.o[k] = Lerp(2 * rng.Uniform() - .5f, b.low[k], b.high[k]);
    for (int k = 0; k < 3; ++k) ray.d[k] = Lerp(rng.Uniform(), b.low[k], b.high[k]) - ray.o[k];
    return ray;
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
