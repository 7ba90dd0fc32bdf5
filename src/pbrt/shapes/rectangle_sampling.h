#pragma once
#include "pbrt/math/warps.h"
#include "pbrt/shapes/shape.h"
#include "pbrt/shapes/spherical.h"

namespace pbrt {

/// Sampling of a rectangle from a point; (s, t) is corner + s * edgeX + t * edgeY. As TriangleSampling: in its plane if
/// small for its distance, else on the sphere.
class RectangleSampling {
  public:
    RectangleSampling(const ShapeSampleContext &from, const Point3 &corner, const Vector3 &edgeX, const Vector3 &edgeY)
        : corner_(corner), edgeX_(edgeX), edgeY_(edgeY), toCorner_(corner - from.p) {
        const Vector3 to[4] = {toCorner_, toCorner_ + edgeX, toCorner_ + edgeY, toCorner_ + edgeX + edgeY};
        Float d2[4];
        for (int i = 0; i < 4; ++i) d2[i] = LengthSquared(to[i]);
        const Float nearest = std::min(std::min(d2[0], d2[1]), std::min(d2[2], d2[3]));
        const bool hasNormal = from.ns != Normal3(0) && nearest > 0;
        inPlane_ = !(LengthSquared(edgeX) + LengthSquared(edgeY) > kMaxSizeSquared * nearest);
        if (!inPlane_) {
            sphere_ = SphericalRectangle(from.p, corner, edgeX, edgeY);
            inPlane_ = !(sphere_.SolidAngle() > kMinSolidAngle);
        }
        if (!inPlane_) {
            for (int i = 0; i < 4; ++i)
                weights_[i] = hasNormal ? std::max(Float(0.01), AbsDot(from.ns, to[i]) / std::sqrt(d2[i])) : Float(1);
            return;
        }
        volume_ = std::abs(Dot(Cross(edgeX, edgeY), toCorner_));
        const Float min = Float(0.01) * std::sqrt(d2[0]);
        for (int i = 0; i < 4; ++i) {
            const Float ratio = nearest > 0 ? d2[0] / d2[i] : Float(1);
            weights_[i] =
                hasNormal ? std::max(min, AbsDot(from.ns, to[i])) * (ratio * ratio) : ratio * std::sqrt(ratio);
        }
    }

    struct Point {
        Point2 st;
        Float pdf;  ///< solid angle; 0 or infinite if sampling fails
    };
    Point Sample(const Point2 &u) const {
        const Point2 square = SampleBilinear(u, weights_);
        if (inPlane_) return {square, InPlane(square)};
        return {sphere_.Sample(square), BilinearPdf(square, weights_) / sphere_.SolidAngle()};
    }
    /// Density of Sample at p, a point of the rectangle, by solid angle.
    Float Pdf(const Point3 &p) const {
        if (!inPlane_) return BilinearPdf(sphere_.Invert(p), weights_) / sphere_.SolidAngle();
        const Vector3 s = p - corner_;
        return InPlane({std::clamp(Dot(s, edgeX_) / LengthSquared(edgeX_), Float(0), Float(1)),
                        std::clamp(Dot(s, edgeY_) / LengthSquared(edgeY_), Float(0), Float(1))});
    }
    bool IsInPlane() const { return inPlane_; }

    /// As in TriangleSampling, of the diagonal. Relative variance at the limit: 0.001.
    static constexpr Float kMaxSizeSquared = 0.2f;
    /// sr; smaller rectangles are sampled in their plane.
    static constexpr Float kMinSolidAngle = 1e-4f;

  private:
    Float InPlane(const Point2 &st) const {
        const Float d2 = LengthSquared(toCorner_ + st.x * edgeX_ + st.y * edgeY_);
        return BilinearPdf(st, weights_) * d2 * std::sqrt(d2) / volume_;
    }
    Point3 corner_;
    Vector3 edgeX_, edgeY_, toCorner_;
    Float weights_[4];  ///< for SampleBilinear
    bool inPlane_;
    Float volume_;  ///< in the plane: absolute triple product of edges and vector to the corner
    SphericalRectangle sphere_;
};

}  // namespace pbrt
