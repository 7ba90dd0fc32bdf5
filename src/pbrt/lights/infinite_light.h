#pragma once
#include "pbrt/images/image.h"
#include "pbrt/lights/environment_light.h"
#include "pbrt/math/distributions.h"
#include "pbrt/math/transform.h"

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

class UniformInfiniteLight final : public EnvironmentLight {
  public:
    UniformInfiniteLight(std::shared_ptr<const DenseSpectrum> radiance, Float scale);

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override;
    SampledSpectrum Le(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda) const override;
    Float MeanRadiance(const Vector3 &) const override { return 1; }
    int Resolution() const override { return 1; }

  private:
    /// Returns no sample if pdfs may be incomplete: BSDF sampling is better (as in stock pbrt-v4).
    std::optional<LightLiSample> SampleDirection(const Point3 &, const Point2 &u, const SampledWavelengths &lambda,
                                                 bool allowIncompletePdfs) const override;
    Float DirectionPdf(const Point3 &, const Vector3 &wi, bool allowIncompletePdfs) const override;

    std::shared_ptr<const DenseSpectrum> radiance_;
    Float scale_;
};

/// Radiance from an RGB image in the equal-area octahedral layout, constant over each pixel.
class ImageInfiniteLight final : public EnvironmentLight {
  public:
    /// `image`: square, channels R, G, B in this order, finite.
    ImageInfiniteLight(const Transform &renderFromLight, Image image, const ColorSpace &colorSpace, Float scale);

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override;
    SampledSpectrum Le(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda) const override;
    Float MeanRadiance(const Vector3 &d) const override;
    int Resolution() const override { return image_.Resolution().x; }

  private:
    /// Samples pixels in proportion to their mean of R, G, B; if pdfs may be incomplete, to the excess over the image
    /// average (Karlik et al. 2019).
    std::optional<LightLiSample> SampleDirection(const Point3 &, const Point2 &u, const SampledWavelengths &lambda,
                                                 bool allowIncompletePdfs) const override;
    Float DirectionPdf(const Point3 &, const Vector3 &wi, bool allowIncompletePdfs) const override;
    /// Position of direction d (unit) on the image's square, and the inverse.
    Point2 SquareTowards(const Vector3 &d) const;
    Vector3 DirectionAt(const Point2 &st) const;
    SampledSpectrum Radiance(const Point2 &st, const SampledWavelengths &lambda) const;

    Transform renderFromLight_;
    Image image_;
    const ColorSpace *colorSpace_;
    Float scale_;
    PiecewiseConstant2D distribution_, compensated_;
};

}  // namespace pbrt
