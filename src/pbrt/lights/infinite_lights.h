#pragma once
#include <array>

#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"
#include "pbrt/images/image.h"
#include "pbrt/lights/environment_light.h"
#include "pbrt/lights/environment_portals.h"
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
        const SampledSpectrum L = scale_ * irradiance_->Sample(lambda);
        if (!L) return {};
        return LightLiSample{.L = L, .wi = wi_, .pdf = 1, .pLight = PointOutside(from.p, wi_)};
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
        const SampledSpectrum L = scale_ * radiance_->Sample(lambda);
        if (!L) return {};
        return LightLiSample{.L = L, .wi = SampleUniformSphere(u), .pdf = UniformSpherePdf()};
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
        : renderFromLight_(renderFromLight), isSimilarity_(renderFromLight.UniformScale(1e-4).has_value()),
          image_(std::move(image)), colorSpace_(&colorSpace), scale_(scale) {
        Point2i n = image_.Resolution();
        PBRT_CHECK(n.x == n.y && n.x > 0 && image_.ChannelCount() == 3);
        std::vector<Float> weights;
        double sum = 0;
        ForEachPixel(image_, [&](Point2i p) {
            weights.push_back(MeanOf(LightPixel(image_, p)));
            sum += double(weights.back());
        });
        distribution_ = PiecewiseConstant2D(weights, n.x, n.y);

        auto average = Float(sum / double(weights.size()));
        bool anyLeft = false;
        for (Float &w : weights) {
            w = std::max(w - average, Float(0));
            anyLeft |= w > 0;
        }
        if (!anyLeft) std::fill(weights.begin(), weights.end(), Float(1));
        compensated_ = EnvironmentTable(weights, n.x, n.y);
        ParallelForEach(n.y, 8, [&](int64_t y) {
            for (Point2i p(0, int(y)); p.x < n.x; ++p.x)
                compensated_.ValueOf(p.x, p.y) = ScaledPolynomial::Of(colorSpace, LightPixel(image_, p));
        });
    }

    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override {
        // Mean radiance over the sphere, times 4 pi sr, times the disk area of the scene's bounding sphere.
        return {double(scale_) * Sqr(2 * std::numbers::pi * double(sceneRadius_)),
                AverageIlluminant(image_, *colorSpace_, lambda)};
    }
    SampledSpectrum Le(const Point3 &, const Vector3 &d, const SampledWavelengths &lambda) const override {
        const Point2 st = SquareTowards(d);
        return Radiance(compensated_.ValueAt(st), st, lambda);
    }
    Float MeanRadiance(const Vector3 &d) const override {
        return MeanOf(LightPixel(image_, PixelAt(SquareTowards(d), image_.Resolution())));
    }
    int Resolution() const override { return image_.Resolution().x; }
    const EnvironmentTable *Table() const override { return &compensated_; }

  private:
    /// Samples pixels in proportion to their mean of R, G, B; if pdfs may be incomplete, to the excess over the image
    /// average (Karlik et al. 2019).
    std::optional<LightLiSample> SampleDirection(const Point3 &, const Point2 &u, const SampledWavelengths &lambda,
                                                 bool allowIncompletePdfs) const override {
        const auto sample = [&](const Point2 &st, Float pdfSquare, const ScaledPolynomial &rgb) {
            const SampledSpectrum L = pdfSquare > 0 ? Radiance(rgb, st, lambda) : SampledSpectrum(0);
            if (!L) return std::optional<LightLiSample>();
            const Vector3 wi = DirectionAt(st);
            return std::optional(LightLiSample{.L = L, .wi = wi, .pdf = PdfTowards(wi, pdfSquare)});
        };
        if (allowIncompletePdfs) {
            const auto s = compensated_.Sample(u);
            return sample(s.p, s.pdf, s.value);
        }
        const auto s = distribution_.Sample(u);
        return sample(s.p, s.pdf, compensated_.ValueAt(s.p));
    }
    Float DirectionPdf(const Point3 &, const Vector3 &wi, bool allowIncompletePdfs) const override {
        const Point2 st = SquareTowards(wi);
        return PdfTowards(wi, allowIncompletePdfs ? compensated_.Pdf(st) : distribution_.Pdf(st));
    }
    /// Density by solid angle at a unit direction with density `pdfSquare` on the image's square.
    Float PdfTowards(const Vector3 &wi, Float pdfSquare) const {
        const Float pdf = pdfSquare * Inv4Pi;
        return isSimilarity_ ? pdf : MappedDirectionPdf(renderFromLight_, wi, pdf);
    }
    /// Position of direction d (unit) on the image's square, and the inverse.
    Point2 SquareTowards(const Vector3 &d) const {
        return EqualAreaSphereToSquare(Normalize(renderFromLight_.InverseVector(d)));
    }
    Vector3 DirectionAt(const Point2 &st) const {
        return Normalize(renderFromLight_.Vector(EqualAreaSquareToSphere(st)));
    }
    /// Of the pixel at st, given its colour.
    SampledSpectrum Radiance(const ScaledPolynomial &rgb, const Point2 &st, const SampledWavelengths &lambda) const {
        if (lambda.IsWholeRange()) [[unlikely]]
            return scale_ * PixelIlluminant(image_, PixelAt(st, image_.Resolution()), *colorSpace_, lambda);
        return scale_ * (rgb.Sample(lambda) * colorSpace_->Illuminant().Sample(lambda));
    }

    Transform renderFromLight_;
    bool isSimilarity_;
    Image image_;
    const ColorSpace *colorSpace_;
    Float scale_;
    PiecewiseConstant2D distribution_;
    EnvironmentTable compensated_;  ///< with the pixels' colours
};

/// Environment light visible only through a rectangle, from one side (Bitterli, Wyman and Pharr 2015). As in stock
/// pbrt-v4 the image is resampled to a map over angles: atan(x/z) and atan(y/z) of a direction (x, y, z) in the
/// rectangle's frame. Radiance is constant per map pixel.
class PortalLight final : public EnvironmentLight {
  public:
    /// `image`: as for ImageInfiniteLight. `portal`: corners in order, in the source space of `renderFromPortal`; light
    /// travels against cross(p3 - p0, p1 - p0). The sides at p0 must not be degenerate or parallel. Non-rectangular
    /// corners are replaced by the rectangle from p0 to p2 with a side along p3 - p0.
    PortalLight(const Transform &renderFromLight, const Image &image, const ColorSpace &colorSpace, Float scale,
                const std::array<Point3, 4> &portal, const Transform &renderFromPortal)
        : colorSpace_(&colorSpace), scale_(scale) {
        Point2i n = image.Resolution();
        PBRT_CHECK(n.x == n.y && n.x > 0 && image.ChannelCount() == 3);
        const Portal rectangle = PortalFrom(portal, renderFromPortal);
        frame_ = rectangle.frame;
        map_ = Image(PixelFormat::Float, n, {"R", "G", "B"});
        ParallelForEach(n.y, 8, [&](int64_t y) {
            for (Point2i p(0, int(y)); p.x < n.x; ++p.x) {
                const Vector3 d = frame_.FromLocal(LocalFromMap(PixelCenter(p.x, p.y, n)));
                Point2 st = EqualAreaSphereToSquare(Normalize(renderFromLight.InverseVector(d)));
                for (int c = 0; c < 3; ++c) map_.Set(p, c, image.Bilinear(st, c, WrapMode::OctahedralSphere));
            }
        });
        portal_.emplace(*this, std::span(&rectangle, 1));
    }
    static bool IsRectangle(const std::array<Point3, 4> &p) {
        Vector3 x = Normalize(p[3] - p[0]), y = Normalize(p[1] - p[0]), x2 = Normalize(p[2] - p[1]),
                y2 = Normalize(p[2] - p[3]);
        constexpr Float kTolerance = 1e-3f;  // stock pbrt-v4's
        auto parallel = [](const Vector3 &a, const Vector3 &b) { return std::abs(Dot(a, b) - 1) <= kTolerance; };
        return parallel(x, x2) && parallel(y, y2) && AbsDot(x, y) <= kTolerance;
    }

    /// Entering power: integral of radiance and cosine over the rectangle and the half-space behind it.
    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override {
        Point2i n = map_.Resolution();
        auto cosine = [&](int x, int y) {
            Vector3 w = LocalFromMap(PixelCenter(x, y, n));
            return SolidAngleDensity(w) * w.z;
        };
        return {double(scale_) * double(Area()), AverageIlluminant(map_, *colorSpace_, lambda, cosine)};
    }
    /// Directions in proportion to the radiance, through uniform points on the rectangle.
    std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                          const SampledWavelengths &lambda, uint32_t) const override {
        Float pdfDirection = 0;
        const std::optional<Vector3> local = portal_->Map(0).SampleDirection(uDirection, kHalfSpace, &pdfDirection);
        if (!local || !(local->z > 0) || !(Area() > 0)) return {};
        const SampledSpectrum L = Radiance(*local, lambda);
        if (!L) return {};
        const Vector3 wi = frame_.FromLocal(*local), sides = Rectangle().high - Rectangle().low;
        const Point3 p = frame_.FromLocal(Rectangle().low + sides * Vector3(uPosition, 0));
        return LightLeSample{.L = L,
                             .ray = {.o = PointOutside(p, wi), .d = -wi},
                             .pdfPosition = 1 / (Area() * local->z),
                             .pdfDirection = pdfDirection};
    }
    LightLePdf PdfLe(const Point3 &p, const Normal3 &, const Vector3 &w, uint32_t) const override {
        const Vector3 wi = frame_.ToLocal(-w);
        if (!(wi.z > 0) || !(Area() > 0)) return {};
        const Point3 from = frame_.ToLocal(p);
        const Point2 at = Point2(from) + Vector2(wi) * ((Rectangle().low.z - from.z) / wi.z);
        if (glm::any(glm::lessThan(at, Point2(Rectangle().low))) ||
            glm::any(glm::greaterThan(at, Point2(Rectangle().high))))
            return {};
        return {1 / (Area() * wi.z), portal_->Map(0).DirectionPdf(wi, kHalfSpace)};
    }
    SampledSpectrum Le(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda) const override {
        return Rectangle().IsPassed(o, d) ? Radiance(frame_.ToLocal(d), lambda) : SampledSpectrum(0);
    }
    Float MeanRadiance(const Vector3 &d) const override {
        return MeanOf(LightPixel(map_, PixelTowards(frame_.ToLocal(d))));
    }
    int Resolution() const override { return map_.Resolution().x; }
    std::optional<LightBounds> Opening() const override {
        const double phi = double(Area()) * double(scale_) * double(portal_->Map(0).Integral(kHalfSpace));
        if (!(phi > 0)) return {};
        const auto &[low, high] = std::pair(Rectangle().low, Rectangle().high);
        Bounds3 bounds(frame_.FromLocal(low));
        for (const Point3 &p : {high, Point3(low.x, high.y, low.z), Point3(high.x, low.y, low.z)})
            bounds = Union(bounds, frame_.FromLocal(p));
        return LightBounds{bounds, -frame_.z, phi, 1, 0, false};
    }

  private:
    static constexpr Bounds2 kHalfSpace{{0, 0}, {1, 1}};  ///< on a PortalMap

    /// Frame direction at a point of the map of angles.
    static Vector3 LocalFromMap(const Point2 &st) {
        Float a = Pi * (st.x - Float(0.5)), b = Pi * (st.y - Float(0.5));
        // (tan a, tan b, 1) times both cosines, which is finite at the borders.
        return Normalize(Vector3(std::sin(a) * std::cos(b), std::cos(a) * std::sin(b), std::cos(a) * std::cos(b)));
    }

    /// Solid angle per area of the map of angles, at a unit frame direction.
    static Float SolidAngleDensity(const Vector3 &w) {
        // d(x/z) = pi / cos^2(a) ds with cos^2(a) = z^2 / (1 - y^2), likewise for t; area on the plane at distance 1
        // subtends z^3 times as much solid angle.
        return Pi * Pi * (1 - Sqr(w.x)) * (1 - Sqr(w.y)) / w.z;
    }

    /// x and y along the sides, z outward. Left-handed if the transformation swaps handedness.
    static Portal PortalFrom(const std::array<Point3, 4> &corners, const Transform &renderFromPortal) {
        std::array<Point3, 4> p;
        for (size_t i = 0; i < 4; ++i) p[i] = renderFromPortal.Point(corners[i]);
        Portal portal;
        Frame &frame = portal.frame;
        frame.x = Normalize(p[3] - p[0]);
        frame.z = Normalize(Cross(frame.x, p[1] - p[0]));
        frame.y = Cross(frame.z, frame.x);
        if (renderFromPortal.SwapsHandedness()) frame.z = -frame.z;
        const Point3 a = frame.ToLocal(p[0]), b = frame.ToLocal(p[2]);
        portal.low = {glm::min(Point2(a), Point2(b)), a.z};
        portal.high = {glm::max(Point2(a), Point2(b)), a.z};
        return portal;
    }

    /// Directions through the rectangle from the point, in proportion to the mean of R, G and B.
    std::optional<LightLiSample> SampleDirection(const Point3 &p, const Point2 &u, const SampledWavelengths &lambda,
                                                 bool) const override {
        const std::optional<EnvironmentPortals::Direction> through = portal_->Sample(0, p, u);
        if (!through || !(through->pdf > 0)) return {};
        const SampledSpectrum L = Radiance(frame_.ToLocal(through->wi), lambda);
        if (!L) return {};
        return LightLiSample{.L = L, .wi = through->wi, .pdf = through->pdf};
    }
    Float DirectionPdf(const Point3 &p, const Vector3 &wi, bool) const override { return portal_->Pdf(0, p, wi); }
    /// Map pixel of a frame direction with z > 0.
    Point2i PixelTowards(const Vector3 &w) const {
        const auto fromAngle = [](Float tangent) {
            return std::clamp(std::atan(tangent) * InvPi + Float(0.5), Float(0), Float(1));
        };
        return PixelAt(Point2(fromAngle(w.x / w.z), fromAngle(w.y / w.z)), map_.Resolution());
    }
    SampledSpectrum Radiance(const Vector3 &local, const SampledWavelengths &lambda) const {
        return scale_ * PixelIlluminant(map_, PixelTowards(local), *colorSpace_, lambda);
    }
    const Portal &Rectangle() const { return (*portal_)[0]; }
    Float Area() const {
        const Vector3 sides = Rectangle().high - Rectangle().low;
        return sides.x * sides.y;
    }

    Frame frame_;
    Image map_;
    const ColorSpace *colorSpace_;
    Float scale_;
    std::optional<EnvironmentPortals> portal_;
};

}  // namespace pbrt
