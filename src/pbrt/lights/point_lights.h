#pragma once
#include <mutex>

#include "pbrt/core/error.h"
#include "pbrt/images/image.h"
#include "pbrt/lights/light.h"
#include "pbrt/lights/light_image.h"
#include "pbrt/math/distributions.h"
#include "pbrt/math/frame.h"
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
        const SampledSpectrum L = static_cast<const Self &>(*this).Intensity(-d, lambda) / d2;
        if (!L) return {};
        return LightLiSample{.L = L, .wi = d / std::sqrt(d2), .pdf = 1, .pLight = position_};
    }
    std::optional<LightLeSample> SampleLe(const Point2 &, const Point2 &uDirection, const SampledWavelengths &lambda,
                                          uint32_t) const final {
        const Self &self = static_cast<const Self &>(*this);
        const Vector3 d = self.SampleDirection(uDirection);
        const Float pdf = self.PdfDirection(d);
        if (!(pdf > 0)) return {};
        const SampledSpectrum L = self.Intensity(d, lambda);
        if (!L) return {};
        return LightLeSample{.L = L, .ray = {.o = position_, .d = d}, .pdfPosition = 1, .pdfDirection = pdf};
    }
    LightLePdf PdfLe(const Point3 &, const Normal3 &, const Vector3 &w, uint32_t) const final {
        return {0, static_cast<const Self &>(*this).PdfDirection(w)};
    }

  protected:
    explicit LightAtPoint(const Point3 &position) : Light(LightKind::DeltaPosition), position_(position) {}

    static bool KeepsCones(const Transform &t) { return t.UniformScale(1e-4).has_value(); }
    std::optional<LightBounds> AllAround(double phi) const {
        if (!(phi > 0)) return {};
        return LightBounds{Bounds3(position_), Vector3(0, 0, 1), phi, -1, 0, false};
    }

    Point3 position_;
};

class PointLight final : public LightAtPoint<PointLight> {
  public:
    PointLight(const Point3 &position, std::shared_ptr<const DenseSpectrum> intensity, Float scale)
        : LightAtPoint(position), scale_(scale), intensity_(std::move(intensity)) {}

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override {
        return {4 * std::numbers::pi * double(scale_), intensity_->Sample(lambda)};
    }
    SampledSpectrum Intensity(const Vector3 &, const SampledWavelengths &lambda) const {
        return scale_ * intensity_->Sample(lambda);
    }
    Vector3 SampleDirection(const Point2 &u) const { return SampleUniformSphere(u); }
    Float PdfDirection(const Vector3 &) const { return UniformSpherePdf(); }
    std::optional<LightBounds> Bounds(uint32_t) const override {
        return AllAround(4 * std::numbers::pi * double(scale_) * double(intensity_->MaxValue()));
    }

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
              std::shared_ptr<const DenseSpectrum> intensity, Float scale, Float coneAngle, Float falloffStart)
        : LightAtPoint(renderFromLight.Point(from)), renderFromLight_(renderFromLight), axis_(axis),
          intensity_(std::move(intensity)), scale_(scale), coneAngle_(coneAngle), falloffStart_(falloffStart),
          cosEnd_(std::cos(Radians(coneAngle))), cosStart_(std::cos(Radians(falloffStart))) {}

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override {
        return {double(scale_) * double(PowerPerIntensity(coneAngle_, falloffStart_)), intensity_->Sample(lambda)};
    }
    SampledSpectrum Intensity(const Vector3 &w, const SampledWavelengths &lambda) const {
        return scale_ * Falloff(w) * intensity_->Sample(lambda);
    }
    /// Exactly proportional to Falloff without non-uniform scaling.
    Vector3 SampleDirection(const Point2 &u) const {
        // Share of PowerPerIntensity inside the cone of full intensity.
        const Float inner = 1 - cosStart_, outer = (cosStart_ - cosEnd_) / 2;
        const Float cut = inner / (inner + outer);
        Float cosine;
        if (u.x < cut || !(outer > 0)) {
            cosine = Lerp(cut > 0 ? u.x / cut : u.x, Float(1), cosStart_);
        } else {
            // The cubic p of Falloff has the distribution function 2 h^3 - h^4, inverted by bisection.
            const Float share = (u.x - cut) / (1 - cut);
            Float low = 0, high = 1;
            for (int i = 0; i < 24; ++i) {
                const Float h = (low + high) / 2;
                (h * h * h * (2 - h) < share ? low : high) = h;
            }
            cosine = Lerp((low + high) / 2, cosEnd_, cosStart_);
        }
        const Vector3 aroundZ = SphericalDirectionOfTurn(SafeSqrt(1 - Sqr(cosine)), cosine, u.y);
        return Normalize(renderFromLight_.Vector(Frame::FromZ(axis_).FromLocal(aroundZ)));
    }
    Float PdfDirection(const Vector3 &w) const {
        const Float power = PowerPerIntensity(coneAngle_, falloffStart_);
        return power > 0 ? MappedDirectionPdf(renderFromLight_, w, Falloff(w) / power) : 0;
    }
    std::optional<LightBounds> Bounds(uint32_t) const override {
        const double phi = 4 * std::numbers::pi * double(scale_) * double(intensity_->MaxValue());
        if (!(phi > 0)) return {};
        LightBounds b{Bounds3(position_), Normalize(renderFromLight_.Vector(axis_)), phi, cosStart_, 0, false};
        if (!KeepsCones(renderFromLight_)) {
            b.cosTheta_o = -1;
            return b;
        }
        b.cosTheta_e = std::cos(SafeACos(cosEnd_) - SafeACos(cosStart_));
        // Prevents rounding from removing a thin falloff region.
        if (b.cosTheta_e == 1) b.cosTheta_e = Float(0.999);
        return b;
    }

    /// Power of a light of unit intensity on the axis.
    static Float PowerPerIntensity(Float coneAngle, Float falloffStart) {
        Float cosEnd = std::cos(Radians(coneAngle)), cosStart = std::cos(Radians(falloffStart));
        // The cubic averages to 1/2 over the falloff region.
        return 2 * Pi * ((1 - cosStart) + (cosStart - cosEnd) / 2);
    }
    /// Fraction of the axis intensity along w (render space, any length).
    Float Falloff(const Vector3 &w) const {
        const Float cosine = Dot(Normalize(renderFromLight_.InverseVector(w)), axis_), width = cosStart_ - cosEnd_;
        if (width == 0) return cosine >= cosEnd_ ? Float(1) : Float(0);
        // The cubic p with p(0) = 0, p(1) = 1 and p'(0) = p'(1) = 0 is 3 h^2 - 2 h^3.
        const Float h = std::clamp((cosine - cosEnd_) / width, Float(0), Float(1));
        return (3 - 2 * h) * Sqr(h);
    }

  private:
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
                     Image image)
        : LightAtPoint(renderFromLight.Point({0, 0, 0})), renderFromLight_(renderFromLight),
          intensity_(std::move(intensity)), scale_(scale), image_(std::move(image)), mean_(Mean(image_)) {
        PBRT_CHECK(image_.Resolution().x > 0 && image_.Resolution().x == image_.Resolution().y &&
                   image_.ChannelCount() == 1);
    }

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override {
        return {4 * std::numbers::pi * double(mean_) * double(scale_), intensity_->Sample(lambda)};
    }
    SampledSpectrum Intensity(const Vector3 &w, const SampledWavelengths &lambda) const {
        return scale_ * Share(w) * intensity_->Sample(lambda);
    }
    Vector3 SampleDirection(const Point2 &u) const {
        const Vector3 l = EqualAreaSquareToSphere(Distribution().Sample(u).p);
        return Normalize(renderFromLight_.Vector({l.x, l.z, l.y}));
    }
    Float PdfDirection(const Vector3 &w) const {
        return MappedDirectionPdf(renderFromLight_, w, Distribution().Pdf(SquareTowards(w)) * Inv4Pi);
    }
    std::optional<LightBounds> Bounds(uint32_t) const override {
        // As a point light of equal power (stock pbrt-v4).
        return AllAround(4 * std::numbers::pi * double(mean_) * double(scale_) * double(intensity_->MaxValue()));
    }

    static Float Mean(const Image &image) {
        const Point2i n = image.Resolution();
        double sum = 0;
        ForEachPixel(image, [&](Point2i p) { sum += double(std::max(image.Get(p, 0), Float(0))); });
        return Float(sum / (double(n.x) * double(n.y)));
    }

  private:
    /// Image value in direction w (render space, any length).
    Float Share(const Vector3 &w) const {
        return std::max(image_.Get(PixelAt(SquareTowards(w), image_.Resolution()), 0), Float(0));
    }
    Point2 SquareTowards(const Vector3 &w) const {
        Vector3 l = Normalize(renderFromLight_.InverseVector(w));
        return EqualAreaSphereToSquare({l.x, l.z, l.y});
    }
    /// The image as a distribution, created on first use.
    const PiecewiseConstant2D &Distribution() const {
        std::call_once(distributionReady_, [&] {
            std::vector<Float> weights;
            ForEachPixel(image_, [&](Point2i p) { weights.push_back(std::max(image_.Get(p, 0), Float(0))); });
            distribution_ = PiecewiseConstant2D(weights, image_.Resolution().x, image_.Resolution().y);
        });
        return distribution_;
    }

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
    ProjectionLight(const Transform &renderFromLight, Image image, const ColorSpace &colorSpace, Float scale, Float fov)
        : LightAtPoint(renderFromLight.Point({0, 0, 0})), renderFromLight_(renderFromLight), image_(std::move(image)),
          colorSpace_(&colorSpace), scale_(scale), half_(HalfSize(image_.Resolution(), fov)) {
        PBRT_CHECK(image_.Resolution().x > 0 && image_.Resolution().y > 0 && image_.ChannelCount() == 3);
    }

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override {
        Point2i n = image_.Resolution();
        auto weight = [&](int x, int y) { return PixelSolidAngle(x, y, n, half_); };
        return {double(scale_) * n.x * n.y, AverageIlluminant(image_, *colorSpace_, lambda, weight)};
    }
    SampledSpectrum Intensity(const Vector3 &w, const SampledWavelengths &lambda) const {
        const std::optional<Point2> st = PlaceOf(w);
        if (!st) return SampledSpectrum(0);
        return scale_ * PixelIlluminant(image_, PixelAt(*st, image_.Resolution()), *colorSpace_, lambda);
    }
    Vector3 SampleDirection(const Point2 &u) const {
        const Point2 st = Distribution().Sample(u).p;
        return Normalize(renderFromLight_.Vector({(2 * st.x - 1) * half_.x, (1 - 2 * st.y) * half_.y, 1}));
    }
    Float PdfDirection(const Vector3 &w) const {
        const std::optional<Point2> st = PlaceOf(w);
        if (!st) return 0;
        const Float cosine = Normalize(renderFromLight_.InverseVector(w)).z;
        const Float pdf = Distribution().Pdf(*st) / (4 * half_.x * half_.y * cosine * cosine * cosine);
        return MappedDirectionPdf(renderFromLight_, w, pdf);
    }
    std::optional<LightBounds> Bounds(uint32_t) const override {
        Point2i n = image_.Resolution();
        double sum = 0;
        ForEachPixel(image_, [&](Point2i p) { sum += double(MaxComponent(LightPixel(image_, p))); });
        // Excludes the solid angle, as stock pbrt-v4, to match its probabilities.
        const double phi = double(scale_) * sum / (double(n.x) * double(n.y));
        if (!(phi > 0)) return {};
        Vector3 axis = Normalize(renderFromLight_.Vector({0, 0, 1}));
        if (!KeepsCones(renderFromLight_)) return LightBounds{Bounds3(position_), axis, phi, -1, 0, false};
        Float cosCorner = 1 / std::sqrt(1 + Sqr(half_.x) + Sqr(half_.y));
        return LightBounds{Bounds3(position_), axis, phi, 1, std::min(cosCorner, Float(0.999)), false};
    }

    /// Luminous power of a light of scale 1.
    static Float LuminancePower(const Image &image, const ColorSpace &colorSpace, Float fov) {
        Point2i n = image.Resolution();
        Vector2 half = HalfSize(n, fov);
        Rgb weights = colorSpace.Luminance();
        double sum = 0;
        ForEachPixel(image, [&](Point2i p) {
            sum += double(glm::dot(LightPixel(image, p), weights) * PixelSolidAngle(p.x, p.y, n, half));
        });
        return Float(sum);
    }

  private:
    static Vector2 HalfSize(const Point2i &n, Float fov) {
        auto aspect = Float(n.x) / Float(n.y);
        return std::tan(Radians(fov) / 2) * (aspect > 1 ? Vector2(aspect, 1) : Vector2(1, 1 / aspect));
    }

    /// Solid angle of a pixel: its area on the plane at distance 1 times cos^3.
    static Float PixelSolidAngle(int x, int y, const Point2i &n, const Vector2 &half) {
        Vector2 size(2 * half.x / Float(n.x), 2 * half.y / Float(n.y));
        Float px = (Float(x) + Float(0.5)) * size.x - half.x, py = (Float(y) + Float(0.5)) * size.y - half.y;
        Float d2 = 1 + px * px + py * py;
        return size.x * size.y / (d2 * std::sqrt(d2));
    }

    /// Image position of a direction (any length), in [0, 1]^2; empty outside the image.
    std::optional<Point2> PlaceOf(const Vector3 &w) const {
        Vector3 l = renderFromLight_.InverseVector(w);
        if (!(l.z > 0)) return {};
        Point2 st((1 + l.x / (l.z * half_.x)) / 2, (1 - l.y / (l.z * half_.y)) / 2);
        if (!(st.x >= 0 && st.x <= 1 && st.y >= 0 && st.y <= 1)) return {};
        return st;
    }
    /// Pixels by luminance and solid angle, created on first use.
    const PiecewiseConstant2D &Distribution() const {
        std::call_once(distributionReady_, [&] {
            const Point2i n = image_.Resolution();
            const Rgb luminance = colorSpace_->Luminance();
            std::vector<Float> weights;
            ForEachPixel(image_, [&](Point2i p) {
                weights.push_back(std::max(glm::dot(LightPixel(image_, p), luminance), Float(0)) *
                                  PixelSolidAngle(p.x, p.y, n, half_));
            });
            distribution_ = PiecewiseConstant2D(weights, n.x, n.y);
        });
        return distribution_;
    }
    Transform renderFromLight_;
    Image image_;
    const ColorSpace *colorSpace_;
    Float scale_;
    Vector2 half_;  ///< half size of the image at distance 1
    mutable PiecewiseConstant2D distribution_;
    mutable std::once_flag distributionReady_;
};

}  // namespace pbrt
