#pragma once
#include <vector>

#include "pbrt/shapes/shape.h"

namespace pbrt {

/// Vertex data of a triangle or patch mesh, in object space until placed by the mesh's constructor.
struct MeshData {
    std::vector<uint32_t> indices;  ///< 3 (or 4: (0,0),(1,0),(0,1),(1,1)) per primitive
    std::vector<Point3> p;
    std::vector<Normal3> n;  ///< per vertex or empty
    std::vector<Vector3> s;  ///< per vertex or empty
    std::vector<Point2> uv;  ///< per vertex or empty
};

/// Primitives that share vertices.
class Mesh : public Shape {
  public:
    uint32_t PrimitiveCount() const final { return static_cast<uint32_t>(mesh_.indices.size() / cornerCount_); }
    /// In rendering space, with normals flipped if `reverseOrientation`. There is space after the last vertex, because
    /// Embree reads 16 bytes per vertex.
    const MeshData &Data() const { return mesh_; }

  protected:
    Mesh(ShapeKind kind, size_t cornerCount, MeshData data, const Transform &renderFromObject, bool reverseOrientation);

    MeshData mesh_;
    size_t cornerCount_;  ///< per primitive
    bool flipNormal_;     ///< orientation flag XOR handedness
};

/// Triangles in rendering space. Embree uses the vertex and index buffers directly.
class TriangleMesh final : public Mesh {
  public:
    TriangleMesh(MeshData data, const Transform &renderFromObject, bool reverseOrientation);

    Bounds3 PrimitiveBounds(uint32_t primitive) const override;
    Float Area(uint32_t primitive) const override;
    DirectionCone NormalBounds(uint32_t primitive) const override;
    std::optional<PrimitiveHit> Intersect(uint32_t primitive, const Point3 &o, const Vector3 &d, Float tMin,
                                          Float tMax) const override;
    SurfacePoint Surface(uint32_t primitive, const PrimitiveHit &hit) const override;
    SurfacePoint SurfaceOnRay(uint32_t primitive, const PrimitiveHit &hit, const Point3 &o,
                              const Vector3 &d) const override;
    Point2 Uv(uint32_t primitive, const PrimitiveHit &hit) const override;
    std::optional<ShapeSample> SampleArea(uint32_t primitive, const Point2 &u) const override;
    Float PdfArea(uint32_t primitive, const Point3 &, const Normal3 &) const override {
        const Float area = Area(primitive);
        return area > 0 ? 1 / area : 0;
    }
    std::optional<ShapeSample> Sample(uint32_t primitive, const ShapeSampleContext &from,
                                      const Point2 &u) const override;
    Float PdfSolidAngle(uint32_t primitive, const ShapeSampleContext &from, const Vector3 &wi, const Point3 &pHit,
                        const Normal3 &nHit) const override;

  private:
    struct Corners {
        Point3 p0, p1, p2;
    };
    struct PlaneHit;
    Corners CornersOf(uint32_t primitive) const;
    /// Upper bound of the largest axis-aligned extent; at most twice too large.
    static Float SpanOf(const Corners &corners);
    /// Unit normal on the side of samples and hits at barycentric coordinates b.
    Normal3 OrientedNormal(uint32_t primitive, const Corners &c, const Vector3 &b) const;
    Point2 UvAt(uint32_t primitive, const Vector3 &b) const;
    ShapeSample SampleAt(uint32_t primitive, const Corners &c, const Vector3 &b) const;

    Float largestSpan_ = 0;  ///< SpanOf the largest triangle
};

}  // namespace pbrt
