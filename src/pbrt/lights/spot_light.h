#pragma once
#include "pbrt/lights/light_at_point.h"
#include "pbrt/math/transform.h"

namespace pbrt {

/// Full intensity inside a cone, smooth falloff to zero at its border. The cone is a cone in light space: a stretching
/// transform deforms it, as in stock pbrt-v4.
class SpotLight final : public LightAtPoint<SpotLight> {
  public:
    /// `from` and `axis` (unit) in light space; angles in degrees from the axis, falloffStart <= coneAngle.
    SpotLight(const Transform &renderFromLight, const Point3 &from, const Vector3 &axis,
              std::shared_ptr<const DenseSpectrum> intensity, Float scale, Float coneAngle, Float falloffStart);

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override;
    SampledSpectrum Intensity(const Vector3 &w, const SampledWavelengths &lambda) const;
    /// Exactly in proportion to Falloff, if the transform does not stretch.
    Vector3 SampleDirection(const Point2 &u) const;
    Float PdfDirection(const Vector3 &w) const;
    std::optional<LightBounds> Bounds(uint32_t) const override;

    /// Power of a light of unit intensity on the axis.
    static Float PowerPerIntensity(Float coneAngle, Float falloffStart);
    /// Share of the axis intensity that leaves along w (render space, any length).
    Float Falloff(const Vector3 &w) const;

  private:
    /// Falloff at an angle from the axis whose cosine is given.
    Float FalloffAt(Float cosine) const;
    Transform renderFromLight_;
    Vector3 axis_;
    std::shared_ptr<const DenseSpectrum> intensity_;
    Float scale_;
    Float coneAngle_, falloffStart_;
    Float cosEnd_, cosStart_;
};

}  // namespace pbrt
