#pragma once
#include <memory>

#include "pbrt/math/distributions.h"
#include "pbrt/shapes/triangle_mesh.h"

namespace pbrt {

/// Bilinear patches in rendering space. Rectangles are sampled by solid angle, unless emission has an image.
class BilinearMesh final : public Mesh {
  public:
    /// `emission`: density over (u, v), or null; only for meshes without texture coordinates.
    BilinearMesh(MeshData data, const Transform &renderFromObject, bool reverseOrientation,
                 std::shared_ptr<const PiecewiseConstant2D> emission = nullptr);

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
    Float PdfArea(uint32_t primitive, const Point3 &p, const Normal3 &n) const override;
    std::optional<ShapeSample> Sample(uint32_t primitive, const ShapeSampleContext &from,
                                      const Point2 &u) const override;
    Float PdfSolidAngle(uint32_t primitive, const ShapeSampleContext &from, const Vector3 &wi, const Point3 &pHit,
                        const Normal3 &nHit) const override;

    /// True if sampled by solid angle: planar with right angles, to stock pbrt-v4's tolerance.
    bool IsRectangle(uint32_t primitive) const { return isRectangle_[primitive] != 0; }
    /// p11 = p10 + p01 - p00 up to rounding: (u, v) is then affine on the patch.
    bool IsParallelogram(uint32_t primitive) const;

  private:
    struct Corners {
        Point3 p00, p10, p01, p11;
        Point3 At(const Point2 &uv) const;
        Vector3 DpDu(Float v) const;
        Vector3 DpDv(Float u) const;
        Vector3 Error(const Point2 &uv, const Point3 &p, const Normal3 &n) const;  ///< of p = At(uv)
        /// Lengths of the unnormalised normal at the corners: weights of the bilinear warp in SampleArea.
        void AreaWeights(Float w[4]) const;
    };
    struct PatchHit;
    Corners CornersOf(uint32_t primitive) const;
    template <class T>
    T AtCorners(const std::vector<T> &values, uint32_t primitive, const Point2 &uv) const;
    Point2 Parameters(const Corners &c, const Point3 &p, const Normal3 &n) const;
    Normal3 OrientedNormal(uint32_t primitive, const Corners &c, const Point2 &uv) const;
    ShapeSample SampleAt(uint32_t primitive, const Corners &c, const Point2 &uv) const;
    /// Density of SampleArea at (u, v), by area.
    Float PdfArea(uint32_t primitive, const Corners &c, const Point2 &uv) const;

    std::vector<uint8_t> isRectangle_;
    std::shared_ptr<const PiecewiseConstant2D> emission_;
};

}  // namespace pbrt
