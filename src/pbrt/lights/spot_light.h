#pragma once
#include "pbrt/lights/light_at_point.h"
#include "pbrt/math/transform.h"

namespace pbrt {

/// Full intensity inside a cone with smooth falloff to zero at its border. The cone is defined in light space:
/// non-uniform scaling deforms it, as in stock pbrt-v4.
class SpotLight final : public LightAtPoint<SpotLight> {
  public:
    /// `from` and `axis` (unit) in light space; angles in degrees from the axis, falloffStart <= coneAngle.
    SpotLight(const Transform &renderFromLight, const Point3 &from, const Vector3 &axis,
              std::shared_ptr<const DenseSpectrum> intensity, Float scale, Float coneAngle, Float falloffStart);

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override;
    SampledSpectrum Intensity(const Vector3 &w, const SampledWavelengths &lambda) const;
    /// Exactly proportional to Falloff without non-uniform scaling.
    Vector3 SampleDirection(const Point2 &u) const;
    Float PdfDirection(const Vector3 &w) const;
    std::optional<LightBounds> Bounds(uint32_t) const override;

    /// Power of a light of unit intensity on the axis.
    static Float PowerPerIntensity(Float coneAngle, Float falloffStart);
    /// Fraction of the axis intensity along w (render space, any length).
    Float Falloff(const Vector3 &w) const;

  private:
    Float FalloffAt(Float cosine) const;
    Transform renderFromLight_;
    Vector3 axis_;
    std::shared_ptr<const DenseSpectrum> intensity_;
    Float scale_;
    Float coneAngle_, falloffStart_;
    Float cosEnd_, cosStart_;
};

}  // namespace pbrt
