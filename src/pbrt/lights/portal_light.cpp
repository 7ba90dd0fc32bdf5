#include "pbrt/lights/portal_light.h"

#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"
#include "pbrt/lights/light_image.h"

namespace pbrt {

namespace {

constexpr Bounds2 kHalfSpace{{0, 0}, {1, 1}};  ///< on a PortalMap

/// Frame direction at a point of the map of angles.
Vector3 LocalFromMap(const Point2 &st) {
    Float a = Pi * (st.x - Float(0.5)), b = Pi * (st.y - Float(0.5));
    // (tan a, tan b, 1) times both cosines, which is finite at the borders.
    return Normalize(Vector3(std::sin(a) * std::cos(b), std::cos(a) * std::sin(b), std::cos(a) * std::cos(b)));
}

/// Solid angle per area of the map of angles, at a unit frame direction.
Float SolidAngleDensity(const Vector3 &w) {
    // d(x/z) = pi / cos^2(a) ds with cos^2(a) = z^2 / (1 - y^2), likewise for t; area on the plane at distance 1
    // subtends z^3 times as much solid angle.
    return Pi * Pi * (1 - Sqr(w.x)) * (1 - Sqr(w.y)) / w.z;
}

/// x and y along the sides, z outward. Left-handed if the transformation swaps handedness.
Portal PortalFrom(const std::array<Point3, 4> &corners, const Transform &renderFromPortal) {
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

}  // namespace

bool PortalLight::IsRectangle(const std::array<Point3, 4> &p) {
    Vector3 x = Normalize(p[3] - p[0]), y = Normalize(p[1] - p[0]), x2 = Normalize(p[2] - p[1]),
            y2 = Normalize(p[2] - p[3]);
    constexpr Float kTolerance = 1e-3f;  // stock pbrt-v4's
    auto parallel = [](const Vector3 &a, const Vector3 &b) { return std::abs(Dot(a, b) - 1) <= kTolerance; };
    return parallel(x, x2) && parallel(y, y2) && AbsDot(x, y) <= kTolerance;
}

PortalLight::PortalLight(const Transform &renderFromLight, const Image &image, const ColorSpace &colorSpace,
                         Float scale, const std::array<Point3, 4> &portal, const Transform &renderFromPortal)
    : colorSpace_(&colorSpace), scale_(scale) {
    Point2i n = image.Resolution();
    PBRT_CHECK(n.x == n.y && n.x > 0 && image.ChannelCount() == 3);
    const Portal rectangle = PortalFrom(portal, renderFromPortal);
    frame_ = rectangle.frame;
    map_ = Image(PixelFormat::Float, n, {"R", "G", "B"});
    ParallelFor(n.y, 8, [&](int64_t begin, int64_t end) {
        for (int y = int(begin); y < int(end); ++y)
            for (int x = 0; x < n.x; ++x) {
                const Vector3 d = frame_.FromLocal(LocalFromMap(PixelCenter(x, y, n)));
                Point2 st = EqualAreaSphereToSquare(Normalize(renderFromLight.InverseVector(d)));
                for (int c = 0; c < 3; ++c) map_.Set({x, y}, c, image.Bilinear(st, c, WrapMode::OctahedralSphere));
            }
    });
    portal_.emplace(*this, std::span(&rectangle, 1));
}

Point2i PortalLight::PixelTowards(const Vector3 &w) const {
    const auto fromAngle = [](Float tangent) {
        return std::clamp(std::atan(tangent) * InvPi + Float(0.5), Float(0), Float(1));
    };
    return PixelAt(Point2(fromAngle(w.x / w.z), fromAngle(w.y / w.z)), map_.Resolution());
}

SampledSpectrum PortalLight::Radiance(const Vector3 &local, const SampledWavelengths &lambda) const {
    return scale_ * PixelIlluminant(map_, PixelTowards(local), *colorSpace_, lambda);
}

Float PortalLight::MeanRadiance(const Vector3 &d) const {
    const Rgb rgb = LightPixel(map_, PixelTowards(frame_.ToLocal(d)));
    return (rgb.x + rgb.y + rgb.z) / 3;
}

SampledSpectrum PortalLight::Le(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda) const {
    return Rectangle().IsPassed(o, d) ? Radiance(frame_.ToLocal(d), lambda) : SampledSpectrum(0);
}

std::optional<LightLiSample> PortalLight::SampleDirection(const Point3 &p, const Point2 &u,
                                                          const SampledWavelengths &lambda, bool) const {
    const std::optional<EnvironmentPortals::Direction> through = portal_->Sample(0, p, u);
    if (!through || !(through->pdf > 0)) return {};
    LightLiSample s;
    s.L = Radiance(frame_.ToLocal(through->wi), lambda);
    if (!s.L) return {};
    s.wi = through->wi;
    s.pdf = through->pdf;
    return s;
}

Float PortalLight::DirectionPdf(const Point3 &p, const Vector3 &wi, bool) const { return portal_->Pdf(0, p, wi); }

std::optional<LightLeSample> PortalLight::SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                                   const SampledWavelengths &lambda, uint32_t) const {
    LightLeSample s;
    const std::optional<Vector3> local = portal_->Map(0).SampleDirection(uDirection, kHalfSpace, &s.pdfDirection);
    if (!local || !(local->z > 0) || !(Area() > 0)) return {};
    s.L = Radiance(*local, lambda);
    if (!s.L) return {};
    const Vector3 wi = frame_.FromLocal(*local), sides = Rectangle().high - Rectangle().low;
    const Point3 p = frame_.FromLocal(Rectangle().low + sides * Vector3(uPosition, 0));
    s.ray.o = Beyond(p, wi);
    s.ray.d = -wi;
    s.pdfPosition = 1 / (Area() * local->z);
    return s;
}

LightLePdf PortalLight::PdfLe(const Point3 &p, const Normal3 &, const Vector3 &w, uint32_t) const {
    const Vector3 wi = frame_.ToLocal(-w);
    if (!(wi.z > 0) || !(Area() > 0)) return {};
    const Point3 from = frame_.ToLocal(p);
    const Point2 at = Point2(from) + Vector2(wi) * ((Rectangle().low.z - from.z) / wi.z);
    if (glm::any(glm::lessThan(at, Point2(Rectangle().low))) ||
        glm::any(glm::greaterThan(at, Point2(Rectangle().high))))
        return {};
    return {1 / (Area() * wi.z), portal_->Map(0).DirectionPdf(wi, kHalfSpace)};
}

LightPower PortalLight::Phi(const SampledWavelengths &lambda, uint32_t) const {
    Point2i n = map_.Resolution();
    auto cosine = [&](int x, int y) {
        Vector3 w = LocalFromMap(PixelCenter(x, y, n));
        return SolidAngleDensity(w) * w.z;
    };
    return {double(scale_) * double(Area()), AverageIlluminant(map_, *colorSpace_, lambda, cosine)};
}

std::optional<LightBounds> PortalLight::Opening() const {
    const double phi = double(Area()) * double(scale_) * double(portal_->Map(0).Integral(kHalfSpace));
    if (!(phi > 0)) return {};
    const auto &[low, high] = std::pair(Rectangle().low, Rectangle().high);
    Bounds3 bounds(frame_.FromLocal(low));
    for (const Point3 &p : {high, Point3(low.x, high.y, low.z), Point3(high.x, low.y, low.z)})
        bounds = Union(bounds, frame_.FromLocal(p));
    return LightBounds{bounds, -frame_.z, phi, 1, 0, false};
}

}  // namespace pbrt
