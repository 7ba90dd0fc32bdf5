#pragma once
#include "pbrt/shapes/triangle_mesh.h"

namespace pbrt {

/// Bilinear patches in rendering space; rectangles among them are sampled by solid angle.
class BilinearMesh final : public Shape {
  public:
    BilinearMesh(MeshData data, const Transform &renderFromObject, bool reverseOrientation);

    ShapeKind Kind() const override { return ShapeKind::BilinearMesh; }
    uint32_t PrimitiveCount() const override { return static_cast<uint32_t>(mesh_.indices.size() / 4); }
    Bounds3 PrimitiveBounds(uint32_t primitive) const override;
    Float Area(uint32_t primitive) const override;
    DirectionCone NormalBounds(uint32_t primitive) const override;
    std::optional<PrimitiveHit> Intersect(uint32_t primitive, const Point3 &o, const Vector3 &d, Float tMin,
                                          Float tMax) const override;
    SurfacePoint Surface(uint32_t primitive, const PrimitiveHit &hit) const override;
    Point2 Uv(uint32_t primitive, const PrimitiveHit &hit) const override;
    std::optional<ShapeSample> SampleArea(uint32_t primitive, const Point2 &u) const override;
    std::optional<ShapeSample> Sample(uint32_t primitive, const ShapeSampleContext &from, const Point2 &u) const override;
    Float PdfSolidAngle(uint32_t primitive, const ShapeSampleContext &from, const Vector3 &wi, const Point3 &pHit,
                        const Normal3 &nHit) const override;

    const MeshData &Data() const { return mesh_; }

  private:
    MeshData mesh_;
    bool flipNormal_;
    bool reverseOrientation_;
};

}  // namespace pbrt
