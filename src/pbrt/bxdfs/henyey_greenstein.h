#pragma once
#include "pbrt/math/frame.h"

namespace pbrt {

/// Phase function of Henyey and Greenstein. Directions are those of travel before and after the scattering: g > 0
/// favours forward scattering. The sampling density, by solid angle, equals the function's value.
class HenyeyGreenstein {
  public:
    explicit HenyeyGreenstein(Float g) : g_(std::clamp(g, Float(-0.99), Float(0.99))) {}

    Float Pdf(const Vector3 &in, const Vector3 &out) const {
        Float d = 1 + g_ * g_ - 2 * g_ * Dot(in, out);
        return Inv4Pi * (1 - g_ * g_) / (d * SafeSqrt(d));
    }
    Vector3 Sample(const Vector3 &in, const Point2 &u) const {
        Float c;
        if (std::abs(g_) < Float(1e-3)) {
            c = 1 - 2 * u.x;
        } else {
            Float t = (1 - g_ * g_) / (1 + g_ - 2 * g_ * u.x);
            c = std::clamp((1 + g_ * g_ - t * t) / (2 * g_), Float(-1), Float(1));
        }
        return Frame::FromZ(in).FromLocal(SphericalDirection(SafeSqrt(1 - c * c), c, 2 * Pi * u.y));
    }

  private:
    Float g_;
};

}  // namespace pbrt
