#pragma once
#include "pbrt/math/frame.h"

namespace pbrt {

/// Phase function of Henyey and Greenstein (1941). Directions are unit and point away from the scattering point, so
/// unscattered light has wi = -wo. Measure: solid angle. P is also the sampling density, because sampling is exact.
class HenyeyGreenstein {
  public:
    HenyeyGreenstein() = default;
    /// g in [-1, 1] is the mean cosine of the deflection: above 0 forward, below 0 backward. Clamped to [-0.99, 0.99].
    explicit HenyeyGreenstein(Float g) : g_(std::clamp(g, Float(-0.99), Float(0.99))) {}

    Float G() const { return g_; }
    Float P(const Vector3 &wo, const Vector3 &wi) const {
        const Float d = 1 + g_ * g_ + 2 * g_ * Dot(wo, wi);
        return Inv4Pi * (1 - g_ * g_) / (d * SafeSqrt(d));
    }
    struct Sample {
        Vector3 wi{};
        Float p = 0;  ///< P(wo, wi), also the density of wi
    };
    Sample SampleP(const Vector3 &wo, const Point2 &u) const {
        // Inverse CDF of the cosine, rearranged to avoid division by g.
        const Float s = 1 - 2 * u.x, s2 = s * s, g2 = g_ * g_;
        const Float numerator = s * (1 + g2) + g_ * ((s2 + 3) + g2 * (s2 - 1)) / 2;
        const Float c = std::clamp(numerator / Sqr(1 + g_ * s), Float(-1), Float(1));
        const Vector3 local = SphericalDirection(SafeSqrt(1 - c * c), c, 2 * Pi * u.y);
        const Vector3 wi = Frame::FromZ(-wo).FromLocal(local);
        return {wi, P(wo, wi)};
    }

  private:
    Float g_ = 0;
};

}  // namespace pbrt
