#pragma once
#include "pbrt/lights/light_at_point.h"
#include "pbrt/math/warps.h"

namespace pbrt {

class PointLight final : public LightAtPoint<PointLight> {
  public:
    PointLight(const Point3 &position, std::shared_ptr<const DenseSpectrum> intensity, Float scale);

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override;
    SampledSpectrum Intensity(const Vector3 &, const SampledWavelengths &lambda) const {
        return scale_ * intensity_->Sample(lambda);
    }
    Vector3 SampleDirection(const Point2 &u) const { return SampleUniformSphere(u); }
    Float PdfDirection(const Vector3 &) const { return UniformSpherePdf(); }
    std::optional<LightBounds> Bounds(uint32_t) const override;

  private:
    Float scale_;
    std::shared_ptr<const DenseSpectrum> intensity_;
};

}  // namespace pbrt
