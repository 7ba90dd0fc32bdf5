#pragma once
#include "pbrt/lights/light_at_point.h"

namespace pbrt {

/// Equal intensity in all directions.
class PointLight final : public LightAtPoint<PointLight> {
  public:
    PointLight(const Point3 &position, std::shared_ptr<const DenseSpectrum> intensity, Float scale);

    SampledSpectrum Phi(const SampledWavelengths &lambda, uint32_t) const override;
    SampledSpectrum Intensity(const Vector3 &, const SampledWavelengths &lambda) const {
        return scale_ * intensity_->Sample(lambda);
    }
    std::optional<LightBounds> Bounds(uint32_t) const override;

  private:
    Float scale_;
    std::shared_ptr<const DenseSpectrum> intensity_;
};

}  // namespace pbrt
