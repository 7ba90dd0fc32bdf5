#include "pbrt/lights/portal_light.h"

#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"
#include "pbrt/lights/light_image.h"
#include "pbrt/math/warps.h"

namespace pbrt {

namespace {

/// The direction in the frame at a point of the map.
Vector3 LocalFromMap(const Point2 &st) {
    Float a = Pi * (st.x - Float(0.5)), b = Pi * (st.y - Float(0.5));
    // (tan a, tan b, 1) times both cosines, which stays finite at the borders.
    return Normalize(Vector3(std::sin(a) * std::cos(b), std::cos(a) * std::sin(b), std::cos(a) * std::cos(b)));
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
    : LightBeyondScene(LightKind::Infinite), colorSpace_(&colorSpace), scale_(scale) {
    Point2i n = image.Resolution();
    PBRT_CHECK(n.x == n.y && n.x > 0 && image.ChannelCount() == 3);
    std::array<Point3, 4> p;
    for (size_t i = 0; i < 4; ++i) p[i] = renderFromPortal.Point(portal[i]);
    frame_.x = Normalize(p[3] - p[0]);
    frame_.z = Normalize(Cross(frame_.x, p[1] - p[0]));
    frame_.y = Cross(frame_.z, frame_.x);
    if (renderFromPortal.SwapsHandedness()) frame_.z = -frame_.z;
    Vector3 diagonal = frame_.ToLocal(p[2] - p[0]);
    corner_ = p[0];
    opposite_ = corner_ + frame_.x * diagonal.x + frame_.y * diagonal.y;
    area_ = std::abs(diagonal.x * diagonal.y);

    map_ = Image(PixelFormat::Float, n, {"R", "G", "B"});
    std::vector<Float> weights(static_cast<size_t>(n.x) * static_cast<size_t>(n.y));
    ParallelFor(n.y, 8, [&](int64_t begin, int64_t end) {
        for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
            for (int x = 0; x < n.x; ++x) {
                Vector3 local = LocalFromMap(PixelCenter(x, y, n));
                Point2 st = EqualAreaSphereToSquare(Normalize(renderFromLight.InverseVector(frame_.FromLocal(local))));
                for (int c = 0; c < 3; ++c) map_.Set({x, y}, c, image.Bilinear(st, c, WrapMode::OctahedralSphere));
                Rgb rgb = LightPixel(map_, {x, y});
                weights[static_cast<size_t>(y) * static_cast<size_t>(n.x) + static_cast<size_t>(x)] =
                    (rgb.x + rgb.y + rgb.z) / 3 * SolidAngleDensity(local);
            }
    });
    distribution_ = WindowedPiecewiseConstant2D(weights, n.x, n.y);
}

std::optional<Point2> PortalLight::MapFromDirection(const Vector3 &d) const {
    Vector3 w = frame_.ToLocal(d);
    if (!(w.z > 0)) return {};
    auto fromAngle = [](Float tangent) {
        return std::clamp(std::atan(tangent) * InvPi + Float(0.5), Float(0), Float(1));
    };
    return Point2(fromAngle(w.x / w.z), fromAngle(w.y / w.z));
}

Float PortalLight::SolidAngleDensity(const Vector3 &w) {
    // d(x/z) = pi / cos^2(a) ds with cos^2(a) = z^2 / (1 - y^2), likewise for t; an area on the plane at distance 1
    // subtends z^3 times as much solid angle.
    return Pi * Pi * (1 - Sqr(w.x)) * (1 - Sqr(w.y)) / w.z;
}

std::optional<Bounds2> PortalLight::Window(const Point3 &p) const {
    std::optional<Point2> a = MapFromDirection(corner_ - p), b = MapFromDirection(opposite_ - p);
    if (!a || !b) return {};
    return Bounds2{glm::min(*a, *b), glm::max(*a, *b)};
}

SampledSpectrum PortalLight::Radiance(const Point2 &st, const SampledWavelengths &lambda) const {
    return scale_ * PixelIlluminant(map_, PixelAt(st, map_.Resolution()), *colorSpace_, lambda);
}

SampledSpectrum PortalLight::Le(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda) const {
    std::optional<Point2> st = MapFromDirection(d);
    if (!st) return SampledSpectrum(0);
    std::optional<Bounds2> window = Window(o);
    if (!window ||
        !(st->x >= window->low.x && st->x <= window->high.x && st->y >= window->low.y && st->y <= window->high.y))
        return SampledSpectrum(0);
    return Radiance(*st, lambda);
}

std::optional<LightLiSample> PortalLight::SampleLi(const LightSampleContext &from, const Point2 &u,
                                                   const SampledWavelengths &lambda, bool, uint32_t) const {
    std::optional<Bounds2> window = Window(from.p);
    if (!window) return {};
    Float pdfMap = 0;
    std::optional<Point2> st = distribution_.Sample(u, *window, &pdfMap);
    if (!st) return {};
    Vector3 local = LocalFromMap(*st);
    Float density = SolidAngleDensity(local);
    if (!(local.z > 0) || !(density > 0)) return {};
    LightLiSample s;
    s.L = Radiance(*st, lambda);
    if (!s.L) return {};
    s.wi = frame_.FromLocal(local);
    s.pdf = pdfMap / density;
    s.pLight = Beyond(from.p, s.wi);
    return s;
}

Float PortalLight::PdfLi(const LightSampleContext &from, const Vector3 &wi, const Point3 &, const Normal3 &, bool,
                         uint32_t) const {
    std::optional<Point2> st = MapFromDirection(wi);
    if (!st) return 0;
    std::optional<Bounds2> window = Window(from.p);
    if (!window) return 0;
    Float density = SolidAngleDensity(Normalize(frame_.ToLocal(wi)));
    return density > 0 ? distribution_.Pdf(*st, *window) / density : 0;
}

std::optional<LightLeSample> PortalLight::SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                                   const SampledWavelengths &lambda, uint32_t) const {
    Float pdfMap = 0;
    const std::optional<Point2> st = distribution_.Sample(uDirection, {{0, 0}, {1, 1}}, &pdfMap);
    if (!st || !(area_ > 0)) return {};
    const Vector3 local = LocalFromMap(*st);
    const Float density = SolidAngleDensity(local);
    if (!(local.z > 0) || !(density > 0)) return {};
    LightLeSample s;
    s.L = Radiance(*st, lambda);
    if (!s.L) return {};
    const Vector3 wi = frame_.FromLocal(local), diagonal = frame_.ToLocal(opposite_ - corner_);
    const Point3 p = corner_ + frame_.x * (diagonal.x * uPosition.x) + frame_.y * (diagonal.y * uPosition.y);
    s.ray.o = Beyond(p, wi);
    s.ray.d = -wi;
    s.pdfPosition = 1 / (area_ * local.z);
    s.pdfDirection = pdfMap / density;
    return s;
}

LightLePdf PortalLight::PdfLe(const Point3 &p, const Normal3 &, const Vector3 &w, uint32_t) const {
    const Vector3 wi = -w;
    const std::optional<Point2> st = MapFromDirection(wi);
    const Float height = Dot(corner_ - p, frame_.z), cosine = Dot(wi, frame_.z);
    if (!st || !(cosine > 0) || !(area_ > 0)) return {};
    // Where the ray crosses the rectangle's plane.
    const Vector3 at = frame_.ToLocal(p + wi * (height / cosine) - corner_),
                  diagonal = frame_.ToLocal(opposite_ - corner_);
    const Float x = at.x / diagonal.x, y = at.y / diagonal.y;
    if (!(x >= 0 && x <= 1 && y >= 0 && y <= 1)) return {};
    const Float density = SolidAngleDensity(Normalize(frame_.ToLocal(wi)));
    if (!(density > 0)) return {};
    return {1 / (area_ * cosine), distribution_.Pdf(*st, {{0, 0}, {1, 1}}) / density};
}

LightPower PortalLight::Phi(const SampledWavelengths &lambda, uint32_t) const {
    Point2i n = map_.Resolution();
    auto cosine = [&](int x, int y) {
        Vector3 w = LocalFromMap(PixelCenter(x, y, n));
        return SolidAngleDensity(w) * w.z;
    };
    return {double(scale_) * double(area_), AverageIlluminant(map_, *colorSpace_, lambda, cosine)};
}

std::optional<LightBounds> PortalLight::Opening() const {
    const double phi = double(area_) * double(scale_) * static_cast<double>(distribution_.Integral({{0, 0}, {1, 1}}));
    if (!(phi > 0)) return {};
    Bounds3 bounds(corner_);
    for (const Point3 &p : {opposite_, corner_ + frame_.x * Dot(opposite_ - corner_, frame_.x),
                            corner_ + frame_.y * Dot(opposite_ - corner_, frame_.y)})
        bounds = Union(bounds, p);
    return LightBounds{bounds, -frame_.z, phi, 1, 0, false};
}

}  // namespace pbrt
