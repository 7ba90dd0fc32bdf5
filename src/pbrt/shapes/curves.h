#pragma once
#include <array>
#include <span>
#include <vector>

#include "pbrt/shapes/shape.h"

namespace pbrt {

struct CubicBezier {
    std::array<Point3, 4> p{};

    Point3 At(Float u) const { return Blossom(u, u, u); }
    Vector3 Derivative(Float u) const {
        Vector3 a = Lerp(u, p[1] - p[0], p[2] - p[1]), b = Lerp(u, p[2] - p[1], p[3] - p[2]);
        return Float(3) * Lerp(u, a, b);
    }
    CubicBezier Part(Float u0, Float u1) const {
        return {{Blossom(u0, u0, u0), Blossom(u0, u0, u1), Blossom(u0, u1, u1), Blossom(u1, u1, u1)}};
    }
    void Halves(CubicBezier *first, CubicBezier *second) const {
        constexpr Float kHalf = 0.5f;
        Point3 p01 = (p[0] + p[1]) * kHalf, p12 = (p[1] + p[2]) * kHalf, p23 = (p[2] + p[3]) * kHalf;
        Point3 p012 = (p01 + p12) * kHalf, p123 = (p12 + p23) * kHalf;
        Point3 middle = (p012 + p123) * kHalf;
        *first = {{p[0], p01, p012, middle}};
        *second = {{middle, p123, p23, p[3]}};
    }
    /// Multi-affine form: B(u, u, u) is the point at u.
    Point3 Blossom(Float a, Float b, Float c) const {
        Point3 p01 = Lerp(a, p[0], p[1]), p12 = Lerp(a, p[1], p[2]), p23 = Lerp(a, p[2], p[3]);
        return Lerp(c, Lerp(b, p01, p12), Lerp(b, p12, p23));
    }
    /// Largest component of the second differences; 6 times it bounds the second derivative.
    Float LargestSecondDifference() const {
        return std::max(MaxComponent(Abs(p[0] - Float(2) * p[1] + p[2])),
                        MaxComponent(Abs(p[1] - Float(2) * p[2] + p[3])));
    }
};

enum class CurveBasis { Bezier, BSpline };

/// Number of segments for `count` control points; 0 if the count is invalid.
size_t SegmentCount(size_t count, int degree, CurveBasis basis);
/// Segment `index` as a cubic. Degree 2 or 3; B-splines are uniform.
CubicBezier SegmentOf(std::span<const Point3> points, size_t index, int degree, CurveBasis basis);

/// Orientation of the strip. Flat and Cylinder face the ray; Cylinder has the normals of a round tube; Ribbon is
/// oriented by normals and looks narrower from the side.
enum class CurveKind { Flat, Cylinder, Ribbon };

/// Curve segments as ray-facing strips, as in stock pbrt-v4. A ray hits a segment where it passes, in projection, at
/// less than half the width; the hit has the distance of the curve itself. u runs along each segment, v across (hits
/// are (u, v)). The error bound is the width at the hit, per axis of object space, as in stock; it offsets outgoing
/// rays.
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

    uint32_t PrimitiveCount() const override { return uint32_t(pieces_.size()); }
    Bounds3 PrimitiveBounds(uint32_t primitive) const override;
    std::optional<PrimitiveHit> Intersect(uint32_t primitive, const Ray &ray, Float tMin) const override;
    SurfacePoint SurfaceOnRay(uint32_t primitive, const PrimitiveHit &hit, const Ray &ray) const override;

    size_t SegmentCount() const { return segments_.size(); }
    const Segment &SegmentOfPrimitive(uint32_t primitive) const { return segments_[pieces_[primitive].segment]; }

  private:
    /// Part `index` of 2^log2Count equal parts (in u) of a segment.
    struct Piece {
        uint32_t segment : 27;
        uint32_t log2Count : 2;
        uint32_t index : 3;
        Float U0() const { return Float(index) / Float(1u << log2Count); }
        Float U1() const { return Float(index + 1) / Float(1u << log2Count); }
    };
    struct Search;

    static void AddPieces(const Segment &segment, size_t index, std::vector<Piece> *pieces);
    static Bounds3 PieceBounds(const Segment &segment, Float u0, Float u1);
    Normal3 RibbonNormal(uint32_t segment, Float u) const;
    std::pair<Point3, Vector3> RayToSegments(const Ray &ray) const;

    CurveKind kind_;
    std::vector<Segment> segments_;
    std::vector<Normal3> normals_;
    std::vector<Piece> pieces_;
    /// From the segments' space. Identity if renderFromObject scales uniformly: then segments are in rendering space.
    Transform renderFromSegments_;
    bool isPlaced_;
    Vector3 errorOfWidth_{1};  ///< error bound over the width: a cube of object space, bounded in the segments' space
    Float side_ = 1;           ///< -1 if the segments' space mirrors object space
    Float normalSide_;
};

}  // namespace pbrt
