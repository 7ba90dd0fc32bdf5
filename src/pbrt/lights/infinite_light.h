#pragma once
#include <mutex>

#include "pbrt/images/image.h"
#include "pbrt/lights/light_beyond_scene.h"
#include "pbrt/math/distributions.h"
#include "pbrt/math/transform.h"
#include "pbrt/math/windowed_distribution.h"

namespace pbrt {

/// The same radiance from everywhere.
class UniformInfiniteLight final : public LightBeyondScene {
  public:
    UniformInfiniteLight(std::shared_ptr<const DenseSpectrum> radiance, Float scale);

    SampledSpectrum Phi(const SampledWavelengths &lambda, uint32_t) const override;
    /// Draws nothing of the whole light if pdfs may be incomplete: BSDF sampling finds it better (as in stock pbrt-v4).
    /// Tiles are drawn with uniform density.
    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool allowIncompletePdfs,
                                          uint32_t part) const override;
    Float PdfLi(const LightSampleContext &from, const Vector3 &wi, const Point3 &pHit, const Normal3 &nHit,
                bool allowIncompletePdfs, uint32_t part) const override;
    std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                          const SampledWavelengths &lambda, uint32_t part) const override {
        return EvenlyAgainst(SampleLi({}, uDirection, lambda, false, part), uPosition);
    }
    LightLePdf PdfLe(const Point3 &, const Normal3 &, const Vector3 &w, uint32_t part) const override {
        return {PdfOfDisk(), PdfLi({}, -w, Point3(0), Normal3(0), false, part)};
    }
    SampledSpectrum Le(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda) const override;
    bool HasTiles() const override { return true; }
    Point2 SquareTowards(const Vector3 &d) const override;
    Vector3 DirectionAt(const Point2 &st) const override;

  private:
    std::shared_ptr<const DenseSpectrum> radiance_;
    Float scale_;
};

/// Radiance from an RGB image in the equal-area octahedral layout, constant over each pixel.
class ImageInfiniteLight final : public LightBeyondScene {
  public:
    /// `image`: square, channels R, G, B in this order, finite.
    ImageInfiniteLight(const Transform &renderFromLight, Image image, const ColorSpace &colorSpace, Float scale);

    SampledSpectrum Phi(const SampledWavelengths &lambda, uint32_t) const override;
    /// Draws pixels in proportion to their mean of R, G, B; if pdfs may be incomplete, in proportion to what exceeds
    /// the image's average (Karlik et al. 2019). Pixels of a tile: in proportion to their mean.
    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool allowIncompletePdfs,
                                          uint32_t part) const override;
    Float PdfLi(const LightSampleContext &from, const Vector3 &wi, const Point3 &pHit, const Normal3 &nHit,
                bool allowIncompletePdfs, uint32_t part) const override;
    std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                          const SampledWavelengths &lambda, uint32_t part) const override {
        return EvenlyAgainst(SampleLi({}, uDirection, lambda, false, part), uPosition);
    }
    LightLePdf PdfLe(const Point3 &, const Normal3 &, const Vector3 &w, uint32_t part) const override {
        return {PdfOfDisk(), PdfLi({}, -w, Point3(0), Normal3(0), false, part)};
    }
    SampledSpectrum Le(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda) const override;
    bool HasTiles() const override { return true; }
    void PrepareTiles() const override;
    Point2 SquareTowards(const Vector3 &d) const override;
    Vector3 DirectionAt(const Point2 &st) const override;

  private:
    SampledSpectrum Radiance(const Point2 &st, const SampledWavelengths &lambda) const;
    std::vector<Float> PixelMeans() const;
    std::optional<LightLiSample> SampleAt(const LightSampleContext &from, const Point2 &st, Float pdfSquare,
                                          const SampledWavelengths &lambda) const;

    Transform renderFromLight_;
    Image image_;
    const ColorSpace *colorSpace_;
    Float scale_;
    PiecewiseConstant2D distribution_, compensated_;
    /// The distribution again, for tiles: 12 bytes a pixel, so it is made only when a light sampler asks for it.
    mutable WindowedPiecewiseConstant2D tiles_;
    mutable std::once_flag tilesReady_;
};

}  // namespace pbrt
