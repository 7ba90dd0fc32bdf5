#pragma once
#include "pbrt/images/image.h"
#include "pbrt/lights/light.h"
#include "pbrt/math/transform.h"

namespace pbrt {

/// A slide projector that is a point: an RGB image is thrown along +z, its top towards +y, its right towards +x.
class ProjectionLight final : public Light {
  public:
    /// `image`: channels R, G, B in this order, finite. `fov` in degrees, of the image's shorter side, below 180.
    ProjectionLight(const Transform &renderFromLight, Image image, const ColorSpace &colorSpace, Float scale,
                    Float fov);

    SampledSpectrum Phi(const SampledWavelengths &lambda) const override;
    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool allowIncompletePdfs) const override;
    Float PdfLi(const LightSampleContext &, const Vector3 &, const Point3 &, const Normal3 &, bool) const override {
        return 0;
    }
    std::optional<LightBounds> Bounds() const override;

    /// Luminous power of a light of scale 1.
    static Float LuminancePower(const Image &image, const ColorSpace &colorSpace, Float fov);

  private:
    /// Intensity along w (render space, any length), before scale.
    SampledSpectrum Intensity(const Vector3 &w, const SampledWavelengths &lambda) const;

    Transform renderFromLight_;
    Point3 position_;
    Image image_;
    const ColorSpace *colorSpace_;
    Float scale_;
    Vector2 half_;  ///< half size of the image at distance 1
};

}  // namespace pbrt
