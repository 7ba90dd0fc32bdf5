#pragma once
#include "pbrt/lights/light.h"

namespace pbrt {

/// Equal intensity in all directions.
class PointLight final : public Light {
  public:
    PointLight(const Point3 &position, std::shared_ptr<const DenseSpectrum> intensity, Float scale);

    SampledSpectrum Phi(const SampledWavelengths &lambda) const override;
    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool allowIncompletePdfs) const override;
    Float PdfLi(const LightSampleContext &, const Vector3 &, const Point3 &, const Normal3 &, bool) const override {
        return 0;
    }
    std::optional<LightBounds> Bounds() const override;

  private:
    Point3 position_;
    Float scale_;
    std::shared_ptr<const DenseSpectrum> intensity_;
};

}  // namespace pbrt
