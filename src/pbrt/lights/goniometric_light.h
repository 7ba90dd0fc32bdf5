#pragma once
#include <mutex>

#include "pbrt/images/image.h"
#include "pbrt/lights/light_at_point.h"
#include "pbrt/math/distributions.h"
#include "pbrt/math/transform.h"

namespace pbrt {

/// Point light whose directional intensity is a spectrum times an image in the equal-area octahedral layout.
class GoniometricLight final : public LightAtPoint<GoniometricLight> {
  public:
    /// `image`: square, one channel, finite; negative values count as 0. Its +z is the light's +y.
    GoniometricLight(const Transform &renderFromLight, std::shared_ptr<const DenseSpectrum> intensity, Float scale,
                     Image image);

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override;
    SampledSpectrum Intensity(const Vector3 &w, const SampledWavelengths &lambda) const;
    Vector3 SampleDirection(const Point2 &u) const;
    Float PdfDirection(const Vector3 &w) const;
    std::optional<LightBounds> Bounds(uint32_t) const override;

    static Float Mean(const Image &image);

  private:
    /// Image value in direction w (render space, any length).
    Float Share(const Vector3 &w) const;
    Point2 SquareTowards(const Vector3 &w) const;
    /// The image as a distribution, created on first use.
    const PiecewiseConstant2D &Distribution() const;

    Transform renderFromLight_;
    std::shared_ptr<const DenseSpectrum> intensity_;
    Float scale_;
    Image image_;
    Float mean_;
    mutable PiecewiseConstant2D distribution_;
    mutable std::once_flag distributionReady_;
};

}  // namespace pbrt
