#pragma once
#include <vector>

#include "pbrt/shapes/shape.h"

namespace pbrt {

/// Error bound, along the normal, of the plane in Embree's test of triangle p0, p1, p2 for rays starting near its point
/// p. The test evaluates (p0 - o) . (a x b) with edges a = p2 - p0 and b = p0 - p1. Each component of the cross product
/// is a difference of products of (a, b) or (b, c), whichever are smaller. With the smaller product m and component N,
/// the products sum to 2 m + N. Roundings: two (edges) of 2 m + N, one of m, four (difference and sum) of N; less than
/// 6 (m + N). Axis-aligned planes have no error. The rounding of p0 - o counts as an error of o, whose bound is per
/// axis.
[[gnu::always_inline]] inline Float PlaneTestError(const Point3 &p0, const Point3 &p1, const Point3 &p2,
                                                   const Point3 &p) {
    // As RobustUnitCross(p1 - p0, p2 - p0), so that compilers share the product. Signs are irrelevant.
    const Vector3 b = p1 - p0, a = p2 - p0, c = p1 - p2, to = Abs(p0 - p), normal = Cross(b, a);
    const Vector3 ab = Abs(Vector3(a.z * b.y, a.x * b.z, a.y * b.x));
    const Vector3 bc = Abs(Vector3(b.z * c.y, b.x * c.z, b.y * c.x));
    const Float squared = LengthSquared(normal);
    // Slivers, and triangles whose squares are not normal numbers.
    if (!(squared > Float(1e-32) && squared < Infinity)) [[unlikely]]
        return Gamma(6) * MaxComponent(to);
    return Gamma(6) * Dot(to, Min(ab, bc) + Abs(normal)) / std::sqrt(squared);
}

/// Ratio of a primitive's span to the hit distance from which float parameters are too coarse for the hit's position.
constexpr Float kLargePrimitive = 256;
inline bool IsLarge(const Vector3 &span, const Vector3 &distance) {
    return glm::any(glm::greaterThan(span, kLargePrimitive * distance));
}
/// Parametric tolerance beyond a primitive's edges for rounding in Embree's tests and in the ray.
constexpr double kLargePrimitiveSlack = 0x1p-20;

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
    uint32_t PrimitiveCount() const final { return uint32_t(mesh_.indices.size() / cornerCount_); }
    /// In rendering space, with normals flipped if `reverseOrientation`. Padded: Embree reads 16 bytes per vertex.
    const MeshData &Data() const { return mesh_; }
    /// The mesh that a shape is; null for other shapes.
    static const Mesh *Of(const Shape &shape) {
        const bool isMesh = shape.Kind() == ShapeKind::TriangleMesh || shape.Kind() == ShapeKind::BilinearMesh;
        return isMesh ? static_cast<const Mesh *>(&shape) : nullptr;
    }
    /// SurfaceOnRay in an instance, whose scale may differ by axis. `distance`: half extents, in the mesh's space, of
    /// the ball around the ray's origin that reaches the hit.
    virtual SurfacePoint SurfaceInInstance(uint32_t primitive, const PrimitiveHit &hit, const Ray &ray,
                                           const Vector3 &distance) const = 0;
    SurfacePoint SurfaceOnRay(uint32_t primitive, const PrimitiveHit &hit, const Ray &ray) const final {
        return SurfaceInInstance(primitive, hit, ray, Vector3(hit.t * MaxComponent(Abs(ray.d))));
    }
    bool IsInPlane(uint32_t primitive, const Point3 &p, const Vector3 &pError) const final;
    /// Intersect, with corners in double precision, replaces Embree's test for planes that are tilted and so large that
    /// its error and the rounding of their corners could be seen. No effect on other meshes. The mesh must be static,
    /// and the camera near the origin.
    void TraceLargePlanesInDouble() { isTracedInDouble_ = !exact_.empty(); }
    bool IsTracedInDouble() const { return isTracedInDouble_; }

  protected:
    static bool IsAtCorner(const PrimitiveHit &hit) { return hit.u == hit.v && (hit.u == 0 || hit.u == 1); }
    Mesh(ShapeKind kind, size_t cornerCount, MeshData data, const Transform &renderFromObject, bool reverseOrientation);
    glm::dvec3 ExactCorner(uint32_t primitive, size_t corner) const {
        const uint32_t v = mesh_.indices[cornerCount_ * size_t(primitive) + corner];
        return isTracedInDouble_ ? exact_[v] : glm::dvec3(mesh_.p[v]);
    }
    /// Sets the point, from double precision, of a hit by a ray from `o`.
    void SetExactPoint(SurfacePoint &s, const glm::dvec3 &p, const Point3 &o) const;
    /// Bounds of corners, with their rounding.
    Bounds3 RoundedBounds(const Bounds3 &b) const;

    MeshData mesh_;
    size_t cornerCount_;  ///< per primitive
    bool flipNormal_;     ///< orientation flag XOR handedness

  private:
    bool HasVisibleTestError() const;

    std::vector<glm::dvec3> exact_;  ///< mesh_.p before rounding, of meshes with HasVisibleTestError
    Vector3 origin_;                 ///< the object's, in rendering space
    bool isTracedInDouble_ = false;
};

/// Triangles in rendering space. Embree uses the vertex and index buffers directly.
class TriangleMesh final : public Mesh {
  public:
    TriangleMesh(MeshData data, const Transform &renderFromObject, bool reverseOrientation);

    Bounds3 PrimitiveBounds(uint32_t primitive) const override;
    Float Area(uint32_t primitive) const override;
    DirectionCone NormalBounds(uint32_t primitive) const override;
    std::optional<PrimitiveHit> Intersect(uint32_t primitive, const Ray &ray, Float tMin) const override;
    PrimitiveHit Completed(uint32_t primitive, const PrimitiveHit &hit, const Ray &ray) const override;
    SurfacePoint Surface(uint32_t primitive, const PrimitiveHit &hit) const override;
    SurfacePoint SurfaceInInstance(uint32_t primitive, const PrimitiveHit &hit, const Ray &ray,
                                   const Vector3 &distance) const override;
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
    /// Upper bound of the extents along the axes; at most twice too large.
    static Vector3 SpanOf(const Corners &corners);
    /// Unit normal on the side of samples and hits at barycentric coordinates b.
    Normal3 OrientedNormal(uint32_t primitive, const Corners &c, const Vector3 &b) const;
    Point2 UvAt(uint32_t primitive, const Vector3 &b) const;
    ShapeSample SampleAt(uint32_t primitive, const Corners &c, const Vector3 &b) const;

    Float largestSpan_ = 0;  ///< largest component of SpanOf of all triangles
};

}  // namespace pbrt
