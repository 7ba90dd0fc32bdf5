#pragma once
#include "pbrt/lights/light_beyond_scene.h"

namespace pbrt {

class DistantLight final : public LightBeyondScene {
  public:
    /// `wi`: unit, from the scene towards the light. A surface that faces it receives `irradiance` times scale.
    DistantLight(const Vector3 &wi, std::shared_ptr<const DenseSpectrum> irradiance, Float scale);

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override;
    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool allowIncompletePdfs,
                                          uint32_t) const override;
    Float PdfLi(const LightSampleContext &, const Vector3 &, const Point3 &, const Normal3 &, bool,
                uint32_t) const override {
        return 0;
    }
    std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &, const SampledWavelengths &lambda,
                                          uint32_t) const override {
        return EvenlyAgainst(SampleLi({}, {}, lambda, false, 0), uPosition);
    }
    LightLePdf PdfLe(const Point3 &, const Normal3 &, const Vector3 &, uint32_t) const override {
        return {PdfOfDisk(), 0};
    }

  private:
    Vector3 wi_;
    std::shared_ptr<const DenseSpectrum> irradiance_;
    Float scale_;
};

}  // namespace pbrt
