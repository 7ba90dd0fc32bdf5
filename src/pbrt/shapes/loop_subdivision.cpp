#include "pbrt/shapes/mesh_sources.h"

#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <map>
#include <memory>

#include "pbrt/core/error.h"

namespace pbrt {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

using Points = std::vector<Point3>;

/// Warren's neighbour weight for an interior vertex of valence n. (OpenSubdiv has Loop's weights, which differ for n =
/// 4, 5 and above 6; hence its position refinement is not used.)
Float InteriorWeight(int n) { return n == 3 ? Float(3) / 16 : Float(3) / (8 * Float(n)); }
/// Boundaries are cubic B-splines. Their limit mask would be 1/6; stock's 1/5 is kept.
constexpr Float kBoundaryWeight = Float(1) / 8, kBoundaryLimitWeight = Float(1) / 5;

/// One-ring of a vertex, counter-clockwise; from boundary edge to boundary edge if on the boundary.
class Ring {
  public:
    void Collect(const Far::TopologyLevel &level, int vertex) {
        vertices_.clear();
        Far::ConstIndexArray edges = level.GetVertexEdges(vertex);
        for (int i = 0; i < edges.size(); ++i) {
            Far::ConstIndexArray ends = level.GetEdgeVertices(edges[i]);
            vertices_.push_back(ends[0] == vertex ? ends[1] : ends[0]);
        }
        isBoundary_ = level.IsVertexBoundary(vertex);
    }
    int Size() const { return int(vertices_.size()); }
    const Point3 &At(const Points &p, int i) const { return p[vertices_[i]]; }

    /// Weighted mean of the vertex and its neighbours (on the boundary, the two boundary neighbours): the given weight
    /// per neighbour, the rest for the vertex.
    Point3 Smoothed(const Points &p, int vertex, Float interiorWeight, Float boundaryWeight) const {
        const Point3 &center = p[vertex];
        if (isBoundary_) return center * (1 - 2 * boundaryWeight) + (At(p, 0) + At(p, Size() - 1)) * boundaryWeight;
        Point3 sum(0);
        for (int i = 0; i < Size(); ++i) sum += At(p, i);
        return center * (1 - Float(Size()) * interiorWeight) + sum * interiorWeight;
    }
    Point3 Refined(const Points &p, int vertex) const {
        return Smoothed(p, vertex, InteriorWeight(Size()), kBoundaryWeight);
    }
    Point3 Limit(const Points &p, int vertex) const {
        Float n = Float(Size());
        return Smoothed(p, vertex, 1 / (n + 3 / (8 * InteriorWeight(Size()))), kBoundaryLimitWeight);
    }
    /// Cross product of the tangents; `p` holds limit positions, as in stock.
    Normal3 LimitNormal(const Points &p, int vertex) const {
        Vector3 along, across;
        if (isBoundary_) {
            along = At(p, Size() - 1) - At(p, 0);
            across = InwardTangent(p, vertex);
        } else {
            along = across = Vector3(0);
            for (int i = 0; i < Size(); ++i) {
                Float angle = 2 * Pi * Float(i) / Float(Size());
                along += At(p, i) * std::cos(angle);
                across -= At(p, i) * std::sin(angle);
            }
        }
        return Cross(along, across);
    }

  private:
    Vector3 InwardTangent(const Points &p, int vertex) const {
        const Point3 &center = p[vertex];
        int n = Size();
        if (n == 2) return At(p, 0) + At(p, 1) - Float(2) * center;
        if (n == 3) return At(p, 1) - center;
        if (n == 4) return Float(2) * (At(p, 1) + At(p, 2)) - At(p, 0) - At(p, 3) - Float(2) * center;
        Float step = Pi / Float(n - 1);
        Vector3 t = -std::sin(step) * (At(p, 0) + At(p, n - 1));
        for (int i = 1; i < n - 1; ++i) t += (2 - 2 * std::cos(step)) * std::sin(Float(i) * step) * At(p, i);
        return t;
    }

    std::vector<int> vertices_;
    bool isBoundary_ = false;
};

Point3 EdgePoint(const Far::TopologyLevel &level, const Points &p, int edge) {
    Far::ConstIndexArray ends = level.GetEdgeVertices(edge);
    Point3 sum = p[ends[0]] + p[ends[1]];
    if (level.IsEdgeBoundary(edge)) return sum * Float(0.5);
    Point3 opposite(0);
    Far::ConstIndexArray faces = level.GetEdgeFaces(edge);
    for (int f = 0; f < faces.size(); ++f) {
        Far::ConstIndexArray corners = level.GetFaceVertices(faces[f]);
        for (int c = 0; c < corners.size(); ++c)
            if (corners[c] != ends[0] && corners[c] != ends[1]) opposite += p[corners[c]];
    }
    return sum * (Float(3) / 8) + opposite * (Float(1) / 8);
}

/// Calls f(ring, vertex) for each vertex of a level.
void ForEachRing(const Far::TopologyLevel &level, auto f) {
    Ring ring;
    for (int v = 0; v < level.GetNumVertices(); ++v) {
        ring.Collect(level, v);
        f(ring, v);
    }
}

Points RefineOnce(const Far::TopologyLevel &level, const Points &p, int childCount) {
    Points children(childCount);
    ForEachRing(level, [&](const Ring &r, int v) { children[level.GetVertexChildVertex(v)] = r.Refined(p, v); });
    for (int e = 0; e < level.GetNumEdges(); ++e) children[level.GetEdgeChildVertex(e)] = EdgePoint(level, p, e);
    return children;
}

/// Throws UserError unless every edge belongs to one face, or to two in opposite directions.
void CheckManifold(std::span<const int> corners) {
    std::map<std::pair<int, int>, size_t> edges;
    for (size_t i = 0; i < corners.size(); ++i) {
        size_t face = i / 3;
        std::pair<int, int> edge(corners[i], corners[3 * face + (i + 1) % 3]);
        if (edge.first == edge.second)
            throw UserError("face {} uses a point twice; subdivision needs proper triangles.", face);
        auto [it, isNew] = edges.emplace(edge, face);
        if (!isNew)
            throw UserError(
                "faces {} and {} share an edge in the same direction; subdivision needs faces "
                "of consistent orientation, at most two at an edge.",
                it->second, face);
    }
}

std::unique_ptr<Far::TopologyRefiner> Refine(const std::vector<int> &corners, int pointCount, int levels) {
    using Descriptor = Far::TopologyDescriptor;
    using Factory = Far::TopologyRefinerFactory<Descriptor>;
    std::vector<int> sizes(corners.size() / 3, 3);
    Descriptor descriptor;
    descriptor.numVertices = pointCount;
    descriptor.numFaces = int(sizes.size());
    descriptor.numVertsPerFace = sizes.data();
    descriptor.vertIndicesPerFace = corners.data();
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
    std::unique_ptr<Far::TopologyRefiner> refiner(
        Factory::Create(descriptor, Factory::Options(Sdc::SCHEME_LOOP, options)));
    PBRT_CHECK(refiner != nullptr);
    const Far::TopologyLevel &base = refiner->GetLevel(0);
    for (int v = 0; v < base.GetNumVertices(); ++v)
        if (base.IsVertexNonManifold(v))
            throw UserError("some point joins faces that share no edge there; subdivision needs a manifold surface.");
    if (levels > 0) {
        Far::TopologyRefiner::UniformOptions uniform(levels);
        uniform.fullTopologyInLastLevel = true;
        refiner->RefineUniform(uniform);
    }
    return refiner;
}

}  // namespace

MeshData LoopSubdivide(std::span<const uint32_t> indices, std::span<const Point3> points, int levels) {
    std::vector<int> newIndex(points.size(), -1), corners;
    corners.reserve(indices.size());
    Points p;
    for (uint32_t i : indices) {
        PBRT_CHECK(i < points.size());
        if (newIndex[i] < 0) {
            newIndex[i] = int(p.size());
            p.push_back(points[i]);
        }
        corners.push_back(newIndex[i]);
    }
    CheckManifold(corners);
    std::unique_ptr<Far::TopologyRefiner> refiner = Refine(corners, int(p.size()), levels);
    for (int i = 0; i < levels; ++i) p = RefineOnce(refiner->GetLevel(i), p, refiner->GetLevel(i + 1).GetNumVertices());

    const Far::TopologyLevel &last = refiner->GetLevel(levels);
    MeshData mesh;
    mesh.p.resize(p.size());
    mesh.n.resize(p.size());
    ForEachRing(last, [&](const Ring &r, int v) { mesh.p[v] = r.Limit(p, v); });
    ForEachRing(last, [&](const Ring &r, int v) { mesh.n[v] = r.LimitNormal(mesh.p, v); });
    mesh.indices.reserve(3 * size_t(last.GetNumFaces()));
    for (int f = 0; f < last.GetNumFaces(); ++f) {
        Far::ConstIndexArray c = last.GetFaceVertices(f);
        for (int i = 0; i < 3; ++i) mesh.indices.push_back(uint32_t(c[i]));
    }
    return mesh;
}

}  // namespace pbrt
