#pragma once
#include <mutex>

#include "pbrt/images/image.h"
#include "pbrt/lights/light.h"
#include "pbrt/math/distributions.h"
#include "pbrt/math/transform.h"
#include "pbrt/math/warps.h"

namespace pbrt {

/// Base of all point-shaped lights. `Self` provides, non-virtually for speed,
///     SampledSpectrum Intensity(const Vector3 &w, const SampledWavelengths &lambda) const
/// for the intensity along w (render space, any nonzero length), and
///     Vector3 SampleDirection(const Point2 &u) const
///     Float PdfDirection(const Vector3 &w) const
/// for unit directions nearly in proportion to it (density by solid angle).
template <class Self>
class LightAtPoint : public Light {
  public:
    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &,
                                          const SampledWavelengths &lambda, bool, uint32_t) const final {
        Vector3 d = position_ - from.p;
        Float d2 = LengthSquared(d);
        if (!(d2 > 0)) return {};
        LightLiSample s;
        s.L = static_cast<const Self &>(*this).Intensity(-d, lambda) / d2;
        if (!s.L) return {};
        s.wi = d / std::sqrt(d2);
        s.pdf = 1;
        s.pLight = position_;
        return s;
    }
    Float PdfLi(const LightSampleContext &, const Vector3 &, const Point3 &, const Normal3 &, bool,
                uint32_t) const final {
        return 0;
    }
    std::optional<LightLeSample> SampleLe(const Point2 &, const Point2 &uDirection, const SampledWavelengths &lambda,
                                          uint32_t) const final {
        const Self &self = static_cast<const Self &>(*this);
        LightLeSample s;
        s.ray.o = position_;
        s.ray.d = self.SampleDirection(uDirection);
        s.pdfPosition = 1;
        s.pdfDirection = self.PdfDirection(s.ray.d);
        if (!(s.pdfDirection > 0)) return {};
        s.L = self.Intensity(s.ray.d, lambda);
        if (!s.L) return {};
        return s;
    }
    LightLePdf PdfLe(const Point3 &, const Normal3 &, const Vector3 &w, uint32_t) const final {
        return {0, static_cast<const Self &>(*this).PdfDirection(w)};
    }

  protected:
    explicit LightAtPoint(const Point3 &position) : Light(LightKind::DeltaPosition), position_(position) {}

    std::optional<LightBounds> AllAround(double phi) const {
        if (!(phi > 0)) return {};
        return LightBounds{Bounds3(position_), Vector3(0, 0, 1), phi, -1, 0, false};
    }

    Point3 position_;
};

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
