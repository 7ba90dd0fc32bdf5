#include "pbrt/lights/projection_light.h"

#include "pbrt/core/error.h"
#include "pbrt/lights/light_image.h"
#include "pbrt/math/transform.h"

namespace pbrt {

namespace {

Vector2 HalfSize(const Point2i &n, Float fov) {
    auto aspect = Float(n.x) / Float(n.y);
    return std::tan(Radians(fov) / 2) * (aspect > 1 ? Vector2(aspect, 1) : Vector2(1, 1 / aspect));
}

/// Solid angle of a pixel: its area on the plane at distance 1 times cos^3.
Float PixelSolidAngle(int x, int y, const Point2i &n, const Vector2 &half) {
    Vector2 size(2 * half.x / Float(n.x), 2 * half.y / Float(n.y));
    Float px = (Float(x) + Float(0.5)) * size.x - half.x, py = (Float(y) + Float(0.5)) * size.y - half.y;
    Float d2 = 1 + px * px + py * py;
    return size.x * size.y / (d2 * std::sqrt(d2));
}

}  // namespace

ProjectionLight::ProjectionLight(const Transform &renderFromLight, Image image, const ColorSpace &colorSpace,
                                 Float scale, Float fov)
    : LightAtPoint(renderFromLight.Point({0, 0, 0})), renderFromLight_(renderFromLight), image_(std::move(image)),
      colorSpace_(&colorSpace), scale_(scale), half_(HalfSize(image_.Resolution(), fov)) {
    PBRT_CHECK(image_.Resolution().x > 0 && image_.Resolution().y > 0 && image_.ChannelCount() == 3);
}

Float ProjectionLight::LuminancePower(const Image &image, const ColorSpace &colorSpace, Float fov) {
    Point2i n = image.Resolution();
    Vector2 half = HalfSize(n, fov);
    Rgb weights = colorSpace.Luminance();
    double sum = 0;
    for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x)
            sum += double(glm::dot(LightPixel(image, {x, y}), weights) * PixelSolidAngle(x, y, n, half));
    return Float(sum);
}

std::optional<Point2> ProjectionLight::PlaceOf(const Vector3 &w) const {
    Vector3 l = renderFromLight_.InverseVector(w);
    if (!(l.z > 0)) return {};
    Point2 st((1 + l.x / (l.z * half_.x)) / 2, (1 - l.y / (l.z * half_.y)) / 2);
    if (!(st.x >= 0 && st.x <= 1 && st.y >= 0 && st.y <= 1)) return {};
    return st;
}

SampledSpectrum ProjectionLight::Intensity(const Vector3 &w, const SampledWavelengths &lambda) const {
    const std::optional<Point2> st = PlaceOf(w);
    if (!st) return SampledSpectrum(0);
    return scale_ * PixelIlluminant(image_, PixelAt(*st, image_.Resolution()), *colorSpace_, lambda);
}

const PiecewiseConstant2D &ProjectionLight::Distribution() const {
    std::call_once(distributionReady_, [&] {
        const Point2i n = image_.Resolution();
        const Rgb luminance = colorSpace_->Luminance();
        std::vector<Float> weights;
        for (int y = 0; y < n.y; ++y)
            for (int x = 0; x < n.x; ++x)
                weights.push_back(std::max(glm::dot(LightPixel(image_, {x, y}), luminance), Float(0)) *
                                  PixelSolidAngle(x, y, n, half_));
        distribution_ = PiecewiseConstant2D(weights, n.x, n.y);
    });
    return distribution_;
}

Vector3 ProjectionLight::SampleDirection(const Point2 &u) const {
    Float pdf;
    const Point2 st = Distribution().Sample(u, &pdf);
    return Normalize(renderFromLight_.Vector({(2 * st.x - 1) * half_.x, (1 - 2 * st.y) * half_.y, 1}));
}

Float ProjectionLight::PdfDirection(const Vector3 &w) const {
    const std::optional<Point2> st = PlaceOf(w);
    if (!st) return 0;
    const Float cosine = Normalize(renderFromLight_.InverseVector(w)).z;
    const Float pdf = Distribution().Pdf(*st) / (4 * half_.x * half_.y * cosine * cosine * cosine);
    return MappedDirectionPdf(renderFromLight_, w, pdf);
}

LightPower ProjectionLight::Phi(const SampledWavelengths &lambda, uint32_t) const {
    Point2i n = image_.Resolution();
    auto weight = [&](int x, int y) { return PixelSolidAngle(x, y, n, half_); };
    return {double(scale_) * n.x * n.y, AverageIlluminant(image_, *colorSpace_, lambda, weight)};
}

std::optional<LightBounds> ProjectionLight::Bounds(uint32_t) const {
    Point2i n = image_.Resolution();
    double sum = 0;
    for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) {
            Rgb rgb = LightPixel(image_, {x, y});
            sum += double(std::max(std::max(rgb.x, rgb.y), rgb.z));
        }
    // Excludes the solid angle, as stock pbrt-v4, to match its probabilities.
    const double phi = double(scale_) * sum / (double(n.x) * double(n.y));
    if (!(phi > 0)) return {};
    Vector3 axis = Normalize(renderFromLight_.Vector({0, 0, 1}));
    if (!IsSimilarity(renderFromLight_)) return LightBounds{Bounds3(position_), axis, phi, -1, 0, false};
    Float cosCorner = 1 / std::sqrt(1 + Sqr(half_.x) + Sqr(half_.y));
    return LightBounds{Bounds3(position_), axis, phi, 1, std::min(cosCorner, Float(0.999)), false};
}

}  // namespace pbrt
