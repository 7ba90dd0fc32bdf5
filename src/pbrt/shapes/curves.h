#pragma once
#include "pbrt/shapes/cubic_bezier.h"
#include "pbrt/shapes/shape.h"

namespace pbrt {

/// Orientation of the strip. Flat and Cylinder face the ray; Cylinder has the normals of a round tube; Ribbon is
/// oriented by normals and looks narrower from the side.
enum class CurveKind { Flat, Cylinder, Ribbon };

/// Curve segments as ray-facing strips, as in stock pbrt-v4. A ray hits a segment where it passes, in projection, at
/// less than half the width; the hit has the distance of the curve itself. u runs along each segment, v across (hits
/// are (u, v)). The error bound is the width at the hit, as in stock, which offsets outgoing rays.
///
/// Segments are subdivided by stock's flatness rule (to 5 % of the width, at least 2^splitDepth parts), because its
/// errors in u and v are visible. Each segment is one or several primitives, for tight bounds. As in stock, curves are
/// not sampled as lights.
class Curves final : public Shape {
  public:
    struct Segment {
        CubicBezier curve;
        Float width0, width1;  ///< at u = 0 and 1, linear between
        int splitDepth = 3;    ///< intersection uses at least 2^splitDepth parts
    };
    /// In object space. `normals`: two per segment for ribbons, at u = 0 and 1; else empty.
    Curves(CurveKind kind, std::vector<Segment> segments, std::vector<Normal3> normals,
           const Transform &renderFromObject, bool reverseOrientation);

    /// Appends the segments of `other` and their primitives. False, without a change, if one shape cannot hold both.
    bool Append(const Curves &other);

    ShapeKind Kind() const override { return ShapeKind::Curves; }
    uint32_t PrimitiveCount() const override { return static_cast<uint32_t>(pieces_.size()); }
    Bounds3 PrimitiveBounds(uint32_t primitive) const override;
    /// Approximately length times width.
    Float Area(uint32_t primitive) const override;
    DirectionCone NormalBounds(uint32_t) const override { return DirectionCone::EntireSphere(); }
    std::optional<PrimitiveHit> Intersect(uint32_t primitive, const Point3 &o, const Vector3 &d, Float tMin,
                                          Float tMax) const override;
    SurfacePoint SurfaceOnRay(uint32_t primitive, const PrimitiveHit &hit, const Point3 &o,
                              const Vector3 &d) const override;
    /// For a view direction perpendicular to the curve.
    SurfacePoint Surface(uint32_t primitive, const PrimitiveHit &hit) const override;
    Point2 Uv(uint32_t, const PrimitiveHit &hit) const override { return {hit.u, hit.v}; }
    std::optional<ShapeSample> SampleArea(uint32_t, const Point2 &) const override { return {}; }
    Float PdfArea(uint32_t, const Point3 &, const Normal3 &) const override { return 0; }
    std::optional<ShapeSample> Sample(uint32_t, const ShapeSampleContext &, const Point2 &) const override {
        return {};
    }
    Float PdfSolidAngle(uint32_t, const ShapeSampleContext &, const Vector3 &, const Point3 &,
                        const Normal3 &) const override {
        return 0;
    }

    size_t SegmentCount() const { return segments_.size(); }
    const Segment &SegmentOfPrimitive(uint32_t primitive) const { return segments_[pieces_[primitive].segment]; }

  private:
    /// Part `index` of 2^log2Count equal parts (in u) of a segment.
    struct Piece {
        uint32_t segment : 27;
        uint32_t log2Count : 2;
        uint32_t index : 3;
        Float U0() const { return static_cast<Float>(index) / static_cast<Float>(1u << log2Count); }
        Float U1() const { return static_cast<Float>(index + 1) / static_cast<Float>(1u << log2Count); }
    };
    struct Search;

    static void AddPieces(const Segment &segment, size_t index, std::vector<Piece> *pieces);
    static Bounds3 PieceBounds(const Segment &segment, Float u0, Float u1);
    Normal3 RibbonNormal(uint32_t segment, Float u) const;
    std::pair<Point3, Vector3> RayToSegments(const Point3 &o, const Vector3 &d) const;

    CurveKind kind_;
    std::vector<Segment> segments_;
    std::vector<Normal3> normals_;
    std::vector<Piece> pieces_;
    /// From the segments' space. Identity if renderFromObject scales uniformly: then segments are in rendering space.
    Transform renderFromSegments_;
    bool isPlaced_;
    Float side_ = 1;  ///< -1 if the segments' space mirrors object space
    Float normalSide_;
};

}  // namespace pbrt
