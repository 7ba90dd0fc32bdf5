#pragma once
#include <mutex>

#include "pbrt/images/image.h"
#include "pbrt/lights/light_at_point.h"
#include "pbrt/math/distributions.h"
#include "pbrt/math/transform.h"

namespace pbrt {

/// Point light that projects an RGB image along +z, its top towards +y, its right towards +x.
class ProjectionLight final : public LightAtPoint<ProjectionLight> {
  public:
    /// `image`: channels R, G, B in this order, finite. `fov` in degrees, of the image's shorter side, below 180.
    ProjectionLight(const Transform &renderFromLight, Image image, const ColorSpace &colorSpace, Float scale,
                    Float fov);

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override;
    SampledSpectrum Intensity(const Vector3 &w, const SampledWavelengths &lambda) const;
    Vector3 SampleDirection(const Point2 &u) const;
    Float PdfDirection(const Vector3 &w) const;
    std::optional<LightBounds> Bounds(uint32_t) const override;

    /// Luminous power of a light of scale 1.
    static Float LuminancePower(const Image &image, const ColorSpace &colorSpace, Float fov);

  private:
    /// Image position of a direction (any length), in [0, 1]^2; empty outside the image.
    std::optional<Point2> PlaceOf(const Vector3 &w) const;
    /// Pixels by luminance and solid angle, created on first use.
    const PiecewiseConstant2D &Distribution() const;
    Transform renderFromLight_;
    Image image_;
    const ColorSpace *colorSpace_;
    Float scale_;
    Vector2 half_;  ///< half size of the image at distance 1
    mutable PiecewiseConstant2D distribution_;
    mutable std::once_flag distributionReady_;
};

}  // namespace pbrt
