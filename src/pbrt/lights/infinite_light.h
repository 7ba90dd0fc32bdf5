#pragma once
#include "pbrt/core/error.h"
#include "pbrt/images/image.h"
#include "pbrt/lights/environment_light.h"
#include "pbrt/lights/light_image.h"
#include "pbrt/math/distributions.h"
#include "pbrt/math/transform.h"
#include "pbrt/math/warps.h"

namespace pbrt {

class DistantLight final : public LightBeyondScene {
  public:
    /// `wi`: unit, from the scene towards the light. A surface that faces it receives `irradiance` times scale.
    DistantLight(const Vector3 &wi, std::shared_ptr<const DenseSpectrum> irradiance, Float scale)
        : LightBeyondScene(LightKind::DeltaDirection), wi_(wi), irradiance_(std::move(irradiance)), scale_(scale) {}

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override {
        return {double(scale_) * std::numbers::pi * Sqr(double(sceneRadius_)), irradiance_->Sample(lambda)};
    }
    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &,
                                          const SampledWavelengths &lambda, bool, uint32_t) const override {
        LightLiSample s;
        s.L = scale_ * irradiance_->Sample(lambda);
        if (!s.L) return {};
        s.wi = wi_;
        s.pdf = 1;
        s.pLight = Beyond(from.p, wi_);
        return s;
    }
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
    UniformInfiniteLight(std::shared_ptr<const DenseSpectrum> radiance, Float scale)
        : radiance_(std::move(radiance)), scale_(scale) {}

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override {
        return {double(scale_) * Sqr(2 * std::numbers::pi * double(sceneRadius_)), radiance_->Sample(lambda)};
    }
    SampledSpectrum Le(const Point3 &, const Vector3 &, const SampledWavelengths &lambda) const override {
        return scale_ * radiance_->Sample(lambda);
    }
    Float MeanRadiance(const Vector3 &) const override { return 1; }
    int Resolution() const override { return 1; }

  private:
    /// Returns no sample if pdfs may be incomplete: BSDF sampling is better (as in stock pbrt-v4).
    std::optional<LightLiSample> SampleDirection(const Point3 &, const Point2 &u, const SampledWavelengths &lambda,
                                                 bool allowIncompletePdfs) const override {
        if (allowIncompletePdfs) return {};
        LightLiSample s;
        s.L = scale_ * radiance_->Sample(lambda);
        if (!s.L) return {};
        s.wi = SampleUniformSphere(u);
        s.pdf = UniformSpherePdf();
        return s;
    }
    Float DirectionPdf(const Point3 &, const Vector3 &, bool allowIncompletePdfs) const override {
        return allowIncompletePdfs ? 0 : UniformSpherePdf();
    }

    std::shared_ptr<const DenseSpectrum> radiance_;
    Float scale_;
};

/// Radiance from an RGB image in the equal-area octahedral layout, constant over each pixel.
class ImageInfiniteLight final : public EnvironmentLight {
  public:
    /// `image`: square, channels R, G, B in this order, finite.
    ImageInfiniteLight(const Transform &renderFromLight, Image image, const ColorSpace &colorSpace, Float scale)
        : renderFromLight_(renderFromLight), image_(std::move(image)), colorSpace_(&colorSpace), scale_(scale) {
        Point2i n = image_.Resolution();
        PBRT_CHECK(n.x == n.y && n.x > 0 && image_.ChannelCount() == 3);
        std::vector<Float> weights;
        weights.reserve(size_t(n.x) * size_t(n.y));
        double sum = 0;
        for (int y = 0; y < n.y; ++y)
            for (int x = 0; x < n.x; ++x) {
                weights.push_back(MeanOf(LightPixel(image_, {x, y})));
                sum += double(weights.back());
            }
        distribution_ = PiecewiseConstant2D(weights, n.x, n.y);

        auto average = Float(sum / double(weights.size()));
        bool anyLeft = false;
        for (Float &w : weights) {
            w = std::max(w - average, Float(0));
            anyLeft |= w > 0;
        }
        if (!anyLeft) std::fill(weights.begin(), weights.end(), Float(1));
        compensated_ = PiecewiseConstant2D(weights, n.x, n.y);
    }

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override {
        // Mean radiance over the sphere, times 4 pi sr, times the disk area of the scene's bounding sphere.
        return {double(scale_) * Sqr(2 * std::numbers::pi * double(sceneRadius_)),
                AverageIlluminant(image_, *colorSpace_, lambda)};
    }
    SampledSpectrum Le(const Point3 &, const Vector3 &d, const SampledWavelengths &lambda) const override {
        return Radiance(SquareTowards(d), lambda);
    }
    Float MeanRadiance(const Vector3 &d) const override {
        return MeanOf(LightPixel(image_, PixelAt(SquareTowards(d), image_.Resolution())));
    }
    int Resolution() const override { return image_.Resolution().x; }

  private:
    /// Samples pixels in proportion to their mean of R, G, B; if pdfs may be incomplete, to the excess over the image
    /// average (Karlik et al. 2019).
    std::optional<LightLiSample> SampleDirection(const Point3 &, const Point2 &u, const SampledWavelengths &lambda,
                                                 bool allowIncompletePdfs) const override {
        Float pdfSquare = 0;
        const Point2 st = (allowIncompletePdfs ? compensated_ : distribution_).Sample(u, &pdfSquare);
        if (!(pdfSquare > 0)) return {};
        LightLiSample s;
        s.L = Radiance(st, lambda);
        if (!s.L) return {};
        s.wi = DirectionAt(st);
        s.pdf = pdfSquare * Inv4Pi;
        return s;
    }
    Float DirectionPdf(const Point3 &, const Vector3 &wi, bool allowIncompletePdfs) const override {
        return (allowIncompletePdfs ? compensated_ : distribution_).Pdf(SquareTowards(wi)) * Inv4Pi;
    }
    /// Position of direction d (unit) on the image's square, and the inverse.
    Point2 SquareTowards(const Vector3 &d) const {
        return EqualAreaSphereToSquare(Normalize(renderFromLight_.InverseVector(d)));
    }
    Vector3 DirectionAt(const Point2 &st) const {
        return Normalize(renderFromLight_.Vector(EqualAreaSquareToSphere(st)));
    }
    SampledSpectrum Radiance(const Point2 &st, const SampledWavelengths &lambda) const {
        return scale_ * PixelIlluminant(image_, PixelAt(st, image_.Resolution()), *colorSpace_, lambda);
    }

    Transform renderFromLight_;
    Image image_;
    const ColorSpace *colorSpace_;
    Float scale_;
    PiecewiseConstant2D distribution_, compensated_;
};

}  // namespace pbrt
