#pragma once
#include <mutex>

#include "pbrt/images/image.h"
#include "pbrt/lights/sky_light.h"
#include "pbrt/math/distributions.h"
#include "pbrt/math/transform.h"
#include "pbrt/math/windowed_distribution.h"

namespace pbrt {

/// The same radiance from everywhere.
class UniformInfiniteLight final : public SkyLight {
  public:
    UniformInfiniteLight(std::shared_ptr<const DenseSpectrum> radiance, Float scale);

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override;
    SampledSpectrum Le(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda) const override;
    Point2 SquareTowards(const Vector3 &d) const override;
    Vector3 DirectionAt(const Point2 &st) const override;

    Float MeanRadianceAt(const Point2 &) const override { return 1; }

  private:
    /// Draws nothing of the whole light if pdfs may be incomplete: BSDF sampling finds it better (as in stock pbrt-v4).
    /// Tiles are drawn with uniform density.
    std::optional<LightLiSample> SampleSky(const Point2 &u, const SampledWavelengths &lambda, bool allowIncompletePdfs,
                                           uint32_t part) const override;
    Float PdfOfSky(const Vector3 &wi, bool allowIncompletePdfs, uint32_t part) const override;

    std::shared_ptr<const DenseSpectrum> radiance_;
    Float scale_;
};

/// Radiance from an RGB image in the equal-area octahedral layout, constant over each pixel.
class ImageInfiniteLight final : public SkyLight {
  public:
    /// `image`: square, channels R, G, B in this order, finite.
    ImageInfiniteLight(const Transform &renderFromLight, Image image, const ColorSpace &colorSpace, Float scale);

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override;
    SampledSpectrum Le(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda) const override;
    void PrepareTiles() const override;
    Point2 SquareTowards(const Vector3 &d) const override;
    Vector3 DirectionAt(const Point2 &st) const override;

    Float MeanRadianceAt(const Point2 &st) const override;
    int SkyResolution() const override { return image_.Resolution().x; }

  private:
    /// Draws pixels in proportion to their mean of R, G, B; if pdfs may be incomplete, in proportion to what exceeds
    /// the image's average (Karlik et al. 2019). Pixels of a tile: in proportion to their mean.
    std::optional<LightLiSample> SampleSky(const Point2 &u, const SampledWavelengths &lambda, bool allowIncompletePdfs,
                                           uint32_t part) const override;
    Float PdfOfSky(const Vector3 &wi, bool allowIncompletePdfs, uint32_t part) const override;
    SampledSpectrum Radiance(const Point2 &st, const SampledWavelengths &lambda) const;
    std::vector<Float> PixelMeans() const;
    std::optional<LightLiSample> SampleAt(const Point2 &st, Float pdfSquare, const SampledWavelengths &lambda) const;

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
