#include "pbrt/shapes/mesh_sources.h"

#include <algorithm>
#include <array>
#include <optional>
#include <tuple>
#include <unordered_map>

#include "pbrt/core/parallel.h"

namespace pbrt {
namespace {

[[noreturn]] void ThrowTooManySplits(const SplitSize &size, Float maxEdge, Float edgeScale) {
    const double wanted = std::max(0.6 * kMaxDisplacedTriangles, 1.1 * size.faces);
    double fitting = double(maxEdge);
    while (size.Triangles(fitting) > wanted) fitting *= 1.02;
    throw DisplacementError(
        "edgelength",
        fmt::format(
            "\"edgelength\" {:g}{} would take about {:.3g} million triangles; at most {} million are made of one "
            "shape. {:.2g} would fit.",
            maxEdge / edgeScale, edgeScale == 1 ? "" : fmt::format(" (times displacement edge scale {:g})", edgeScale),
            std::max(size.Triangles(double(maxEdge)), double(kMaxDisplacedTriangles)) / 1e6,
            kMaxDisplacedTriangles / 1000000, fitting * 1.05 / double(edgeScale)));
}

class Splitter {
  public:
    Splitter(const MeshData &vertices, const Transform &renderFromObject, Float maxEdge, std::function<void()> fail)
        : renderFromObject_(renderFromObject), maxEdge_(maxEdge), fail_(std::move(fail)) {
        mesh_.p = vertices.p;
        mesh_.n = vertices.n;
        mesh_.uv = vertices.uv;
        for (Normal3 &n : mesh_.n)
            if (LengthSquared(n) > 0) n = Normalize(n);
        for (const Point3 &p : mesh_.p) placed_.push_back(renderFromObject_.Point(p));
    }

    void Split(uint32_t a, uint32_t b, uint32_t c) {
        todo_.push_back({a, b, c});
        while (!todo_.empty()) {
            auto [v0, v1, v2] = todo_.back();
            todo_.pop_back();
            const Float d01 = EdgeLength(v0, v1), d12 = EdgeLength(v1, v2), d20 = EdgeLength(v2, v0);
            if (d12 > d01 && d12 >= d20) std::tie(v0, v1, v2) = std::tuple(v1, v2, v0);
            else if (d20 > d01 && d20 > d12) std::tie(v0, v1, v2) = std::tuple(v2, v0, v1);
            const Float longest = std::max({d01, d12, d20});
            const std::optional<uint32_t> middle = longest >= maxEdge_ ? Middle(v0, v1) : std::nullopt;
            if (middle) {
                todo_.push_back({v0, *middle, v2});
                todo_.push_back({*middle, v1, v2});
                continue;
            }
            mesh_.indices.insert(mesh_.indices.end(), {v0, v1, v2});
        }
    }

    MeshData Take() { return std::move(mesh_); }

  private:
    Float EdgeLength(uint32_t a, uint32_t b) const { return Distance(placed_[a], placed_[b]); }

    /// Midpoint vertex of an edge, shared by both faces. Empty if no float lies between the ends.
    std::optional<uint32_t> Middle(uint32_t a, uint32_t b) {
        const uint64_t key = uint64_t(std::min(a, b)) << 32 | std::max(a, b);
        auto [it, isNew] = middles_.emplace(key, uint32_t(mesh_.p.size()));
        if (!isNew) return it->second;
        const Point3 p = (mesh_.p[a] + mesh_.p[b]) / Float(2);
        if (p == mesh_.p[a] || p == mesh_.p[b]) {
            middles_.erase(it);
            return {};
        }
        // Each new vertex adds two triangles, or one at a border.
        if (mesh_.p.size() >= kMaxDisplacedTriangles / 2) fail_();
        const Normal3 n = mesh_.n[a] + mesh_.n[b];
        mesh_.p.push_back(p);
        mesh_.n.push_back(LengthSquared(n) > 0 ? Normalize(n) : mesh_.n[a]);
        mesh_.uv.push_back((mesh_.uv[a] + mesh_.uv[b]) / Float(2));
        placed_.push_back(renderFromObject_.Point(p));
        return it->second;
    }

    const Transform &renderFromObject_;
    Float maxEdge_;
    std::function<void()> fail_;  ///< throws
    MeshData mesh_;
    std::vector<Point3> placed_;  ///< vertices in rendering space
    std::unordered_map<uint64_t, uint32_t> middles_;
    std::vector<std::array<uint32_t, 3>> todo_;
};

void MoveVertices(MeshData &mesh, const Transform &renderFromObject, const Displacement &displacement) {
    ParallelForEach(int64_t(mesh.p.size()), 1024, [&](int64_t i) {
        const Normal3 placed = renderFromObject.Normal(mesh.n[i]);
        const Normal3 n = LengthSquared(placed) > 0 ? Normalize(placed) : placed;
        mesh.p[i] += mesh.n[i] * displacement.height(renderFromObject.Point(mesh.p[i]), n, mesh.uv[i]);
    });
}

/// Vertex normals: mean of the unit face normals, each on the side of the old normals at the face's corners.
void RenewNormals(MeshData &mesh) {
    std::vector<Normal3> sums(mesh.p.size(), Normal3(0));
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        const uint32_t *v = &mesh.indices[i];
        const Normal3 n = Cross(mesh.p[v[1]] - mesh.p[v[0]], mesh.p[v[2]] - mesh.p[v[0]]);
        if (!(LengthSquared(n) > 0)) continue;
        const Normal3 unit = FaceForward(Normalize(n), mesh.n[v[0]] + mesh.n[v[1]] + mesh.n[v[2]]);
        for (int k = 0; k < 3; ++k) sums[v[k]] += unit;
    }
    for (size_t i = 0; i < sums.size(); ++i)
        if (LengthSquared(sums[i]) > 0) mesh.n[i] = Normalize(sums[i]);
}

void ForEachTriangle(const PlyMesh &ply, auto f) {
    const std::vector<uint32_t> &t = ply.triangles.indices, &q = ply.quads.indices;
    for (size_t i = 0; i < t.size(); i += 3) f(t[i], t[i + 1], t[i + 2]);
    for (size_t i = 0; i < q.size(); i += 4) {
        f(q[i], q[i + 1], q[i + 3]);
        f(q[i], q[i + 3], q[i + 2]);
    }
}

}  // namespace

// Bisecting longest edges makes similar triangles with an area of 1/9 to 1/4 of the squared longest edge; narrower
// triangles are only cut across their length.
double SplitSize::Triangles(double maxEdge) const { return faces + 6 * area / (maxEdge * maxEdge) + edges / maxEdge; }

SplitSize MeasureSplit(const PlyMesh &ply, const Transform &renderFromObject) {
    const std::vector<Point3> &p = ply.triangles.indices.empty() ? ply.quads.p : ply.triangles.p;
    SplitSize size;
    ForEachTriangle(ply, [&](uint32_t a, uint32_t b, uint32_t c) {
        const Vector3 u = renderFromObject.Vector(p[b] - p[a]), v = renderFromObject.Vector(p[c] - p[a]);
        ++size.faces;
        size.area += double(CrossLength(u, v)) / 2;
        size.edges += double(std::max({Length(u), Length(v), Distance(u, v)}));
    });
    return size;
}

MeshData DisplaceMesh(const PlyMesh &ply, const Transform &renderFromObject, Float maxEdge,
                      const Displacement &displacement) {
    const MeshData &vertices = ply.triangles.indices.empty() ? ply.quads : ply.triangles;
    if (vertices.uv.empty())
        throw DisplacementError("displacement", "a mesh without texture coordinates cannot be displaced.");
    if (vertices.n.empty()) throw DisplacementError("displacement", "a mesh without normals cannot be displaced.");
    maxEdge *= displacement.edgeScale;
    const SplitSize size = MeasureSplit(ply, renderFromObject);
    auto fail = [&] { ThrowTooManySplits(size, maxEdge, displacement.edgeScale); };
    if (size.Triangles(double(maxEdge)) > kMaxDisplacedTriangles) fail();
    Splitter splitter(vertices, renderFromObject, maxEdge, fail);
    ForEachTriangle(ply, [&](uint32_t a, uint32_t b, uint32_t c) { splitter.Split(a, b, c); });
    MeshData mesh = splitter.Take();
    MoveVertices(mesh, renderFromObject, displacement);
    RenewNormals(mesh);
    return mesh;
}

}  // namespace pbrt
