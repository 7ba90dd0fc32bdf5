#pragma once
#include "pbrt/images/image.h"
#include "pbrt/lights/light.h"
#include "pbrt/math/transform.h"

namespace pbrt {

/// A point whose intensity by direction is a spectrum times an image in the equal-area octahedral layout.
class GoniometricLight final : public Light {
  public:
    /// `image`: square, one channel, finite; negative values count as 0. Its +z is the light's +y.
    GoniometricLight(const Transform &renderFromLight, std::shared_ptr<const DenseSpectrum> intensity, Float scale,
                     Image image);

    SampledSpectrum Phi(const SampledWavelengths &lambda) const override;
    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool allowIncompletePdfs) const override;
    Float PdfLi(const LightSampleContext &, const Vector3 &, const Point3 &, const Normal3 &, bool) const override {
        return 0;
    }
    std::optional<LightBounds> Bounds() const override;

    /// Mean of such an image over all directions.
    static Float Mean(const Image &image);

  private:
    /// The image along w (render space, any length).
    Float Share(const Vector3 &w) const;

    Transform renderFromLight_;
    Point3 position_;
    std::shared_ptr<const DenseSpectrum> intensity_;
    Float scale_;
    Image image_;
    Float mean_;
};

}  // namespace pbrt
