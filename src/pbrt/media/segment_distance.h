#pragma once
#include <algorithm>
#include <cmath>

#include "pbrt/math/ray.h"

namespace pbrt {

/// Distances along a ray, from its origin to tMax, with the density of what a small isotropic light sends there: equal
/// distances in the angle seen from the light (Kulla and Fajardo 2012, Importance Sampling Techniques for Path Tracing
/// in Participating Media, section 3). A light with a radius is taken to be at least that far from the ray, because
/// close to it the light that arrives does not grow further. Density per unit of length. tMax may be infinite; it must
/// be above 0.
class EquiangularDistance {
  public:
    /// The direction of the ray must have unit length.
    EquiangularDistance(const Ray &ray, Float tMax, const Point3 &center, Float radius) : tMax_(tMax) {
        constexpr Float kClosest = 1e-4f;
        const Vector3 to = center - ray.o;
        closest_ = Dot(to, ray.d);
        const Float away2 = LengthSquared(to - ray.d * closest_) + radius * radius;
        away_ = std::sqrt(std::max(away2, kClosest * kClosest * LengthSquared(to)));
        away_ = std::max(away_, std::numeric_limits<Float>::min() * 1e6f);
        // The angle between origin and end as seen from the light, without the difference of two arcs, which would
        // lose all digits for a light far away.
        const Float hypotenuse = std::hypot(away_, closest_);
        cos_ = away_ / hypotenuse;  // of the angle of the origin, which is -atan(closest / away)
        sin_ = -closest_ / hypotenuse;
        angle_ = std::isinf(tMax) ? std::atan2(away_, -closest_)
                                  : std::atan2(away_ * tMax, away_ * away_ - closest_ * (tMax - closest_));
    }
    /// False where floating point cannot tell the angles apart: then there is no density.
    bool IsValid() const { return angle_ > 0 && std::isfinite(away_); }
    Float Sample(Float u) const {
        const Float angle = u * angle_;
        const Float cosEnd = cos_ * std::cos(angle) - sin_ * std::sin(angle);
        const Float t = away_ * std::sin(angle) / (cos_ * cosEnd);
        return t >= 0 ? std::min(t, tMax_) : tMax_;
    }
    Float Pdf(Float t) const {
        const Float x = t - closest_;
        return away_ / (angle_ * (away_ * away_ + x * x));
    }

  private:
    Float tMax_, closest_ = 0, away_ = 0;
    Float cos_ = 1, sin_ = 0, angle_ = 0;
};

/// Distances along a ray, from its origin to tMax, in proportion to the transmittance exp(-sigma t) of an even medium.
/// Density per unit of length. tMax may be infinite if sigma (extinction per unit of length) is above 0.
class TransmittanceDistance {
  public:
    TransmittanceDistance(Float sigma, Float tMax)
        : sigma_(sigma), tMax_(tMax), absorbed_(-std::expm1(-sigma * tMax)) {}
    bool IsValid() const { return absorbed_ > 0; }
    Float Sample(Float u) const { return std::min(-std::log1p(-u * absorbed_) / sigma_, tMax_); }
    Float Pdf(Float t) const { return sigma_ * std::exp(-sigma_ * t) / absorbed_; }

  private:
    Float sigma_, tMax_, absorbed_;  ///< absorbed_: what the whole distance takes of the light
};

}  // namespace pbrt
