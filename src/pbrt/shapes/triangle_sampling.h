#pragma once
#include "pbrt/math/warps.h"
#include "pbrt/shapes/shape.h"
#include "pbrt/shapes/spherical.h"

namespace pbrt {

/// Sampling of directions to a triangle from a point. Inline, to stay in registers.
///
/// With a receiver normal, the density is nearly proportional to the receiver cosine, interpolated between the corners
/// with a minimum of about 0.01; otherwise it is uniform by solid angle. Triangles small for their distance are sampled
/// in their plane: area sampling has solid-angle density d^3 / (area * height) at distance d, which is equalised
/// together with the cosine. Larger ones are sampled on the sphere.
class TriangleSampling {
  public:
    TriangleSampling(const ShapeSampleContext &from, const Point3 &p0, const Point3 &p1, const Point3 &p2)
        : to0_(p0 - from.p), to1_(p1 - from.p), to2_(p2 - from.p), edge1_(p1 - p0), edge2_(p2 - p0) {
        const Float d0 = LengthSquared(to0_), d1 = LengthSquared(to1_), d2 = LengthSquared(to2_);
        const Float nearest = std::min(std::min(d0, d1), d2);
        const Float size = std::max(std::max(LengthSquared(edge1_), LengthSquared(edge2_)), DistanceSquared(p1, p2));
        inPlane_ = !(size > kMaxSizeSquared * nearest && nearest > 0 && TrySphere(from));
        if (!inPlane_) return;
        volume_ = std::abs(Dot(Cross(edge1_, edge2_), to0_));
        if (!(nearest > 0)) {
            SetWeights(1, 1, 1);
            return;
        }
        const Float ratio0 = d1 / d0, ratio2 = d1 / d2;
        if (from.ns == Normal3(0)) {
            SetWeights(ratio0 * std::sqrt(ratio0), 1, ratio2 * std::sqrt(ratio2));
            return;
        }
        const Float min = Float(0.01) * std::sqrt(d1);
        SetWeights(std::max(min, AbsDot(from.ns, to0_)) * (ratio0 * ratio0), std::max(min, AbsDot(from.ns, to1_)),
                   std::max(min, AbsDot(from.ns, to2_)) * (ratio2 * ratio2));
    }

    struct Point {
        Vector3 barycentrics;
        Float pdf;  ///< solid angle; 0 or infinite if sampling fails
    };
    Point Sample(const Point2 &u) const {
        const Point2 square = SampleBilinear(u, weights_);
        if (inPlane_) {
            const Float t = std::sqrt(square.y), across = t * square.x;
            const Vector3 b(t - across, 1 - t, across);
            return {b, InPlane(square, b)};
        }
        const Vector3 b = sphere_.Sample(square) / distance_;
        return {b / (b.x + b.y + b.z), BilinearPdf(square, weights_) / sphere_.Area()};
    }
    /// Density of Sample in direction wi, which must hit the triangle.
    Float Pdf(const Vector3 &wi) const {
        // Hit with the triangle's plane, possibly outside the triangle by rounding.
        const Vector3 k = Cross(wi, edge2_);
        const Float determinant = Dot(k, edge1_);
        if (determinant == 0) return 0;
        const Float inverse = 1 / determinant;
        Vector3 b(0, std::clamp(-Dot(to0_, k) * inverse, Float(0), Float(1)),
                  std::clamp(Dot(wi, Cross(edge1_, to0_)) * inverse, Float(0), Float(1)));
        if (const Float sum = b.y + b.z; sum > 1) b /= sum;
        b.x = std::max(Float(0), 1 - b.y - b.z);
        if (!inPlane_) return BilinearPdf(sphere_.Invert(b * distance_, wi), weights_) / sphere_.Area();
        const Float t = b.x + b.z;
        return InPlane({t > 0 ? b.z / t : Float(0.5), t * t}, b);
    }
    bool IsInPlane() const { return inPlane_; }

    /// Limit, for sampling in the plane, of the squared longest side relative to the squared distance of the nearest
    /// corner. At the limit a diffuse receiver has a mean relative variance of 0.003, as on the sphere with
    /// interpolated cosines without SetWeights (see the test).
    static constexpr Float kMaxSizeSquared = 0.2f;
    /// Limits in sr for the sphere: below, rounding dominates the angles; above, the triangle is nearly a hemisphere.
    static constexpr Float kMinSolidAngle = 2e-4f, kMaxSolidAngle = 6.22f;

  private:
    /// Sets the corner values of a linear density. In the square it depends on sqrt(y), because a row is the fraction y
    /// of the area away from corner 1. The root is replaced by its least-squares line 4/15 + 12/15 y.
    void SetWeights(Float at0, Float at1, Float at2) {
        constexpr Float kNear = Float(4) / 15, kFar = Float(16) / 15, kMin = 0.02f;
        auto between = [&](Float other, Float t) { return std::max(at1 + (other - at1) * t, kMin * at1); };
        weights_[0] = between(at0, kNear);
        weights_[1] = between(at2, kNear);
        weights_[2] = between(at0, kFar);
        weights_[3] = between(at2, kFar);
    }

    bool TrySphere(const ShapeSampleContext &from) {
        distance_ = {Length(to0_), Length(to1_), Length(to2_)};
        const Vector3 a = to0_ / distance_.x, b = to1_ / distance_.y, c = to2_ / distance_.z;
        sphere_ = SphericalTriangle(a, b, c);
        if (!(sphere_.Area() >= kMinSolidAngle && sphere_.Area() <= kMaxSolidAngle)) return false;
        if (from.ns == Normal3(0)) SetWeights(1, 1, 1);
        else
            SetWeights(std::max(Float(0.01), AbsDot(from.ns, a)), std::max(Float(0.01), AbsDot(from.ns, b)),
                       std::max(Float(0.01), AbsDot(from.ns, c)));
        return true;
    }

    Float InPlane(const Point2 &square, const Vector3 &barycentrics) const {
        const Float d2 = LengthSquared(barycentrics.x * to0_ + barycentrics.y * to1_ + barycentrics.z * to2_);
        return BilinearPdf(square, weights_) * 2 * d2 * std::sqrt(d2) / volume_;
    }

    Vector3 to0_, to1_, to2_;  ///< corners relative to the receiver
    Vector3 edge1_, edge2_;
    Float weights_[4];  ///< for SampleBilinear over the square whose side y = 0 is corner 1
    bool inPlane_;
    Float volume_;      ///< in the plane: absolute triple product of the corners
    Vector3 distance_;  ///< on the sphere: of the corners
    SphericalTriangle sphere_;
};

}  // namespace pbrt
