#include "pbrt/lights/environment_portals.h"

#include <algorithm>

#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"

namespace pbrt {
namespace {

/// Pixels per side: the tables of a map fit the second-level cache. Larger ones cost more time than they save noise.
constexpr int kSide = 128;
/// A pixel is subdivided if it may hold this share of the whole map, and the brightest point in or beside it exceeds
/// its mean by this contrast.
constexpr double kDividedShare = 1e-4;
constexpr Float kContrast = 1.5f;
/// Minimum value of pixels and subpixels, relative to the brightest point beside them: the corner of a sun between
/// evaluated points must not be sampled with the probability of its surroundings.
constexpr Float kBesidePixel = 1 / Float(32), kBesidePart = 1 / Float(8);

/// Mean radiance times solid angle per map area.
struct CellRadiance {
    Float mean = 0, max = 0;
};

/// Over the square of this width at `low`, in map units, at `across` points a side; the maximum also `beside` steps
/// past it. Includes the borders, so that no image pixel, which may be a sun, is missed.
CellRadiance EvaluateMapCell(const EnvironmentLight &light, const Frame &frame, const Point2 &low, Float width,
                             int across, int beside) {
    CellRadiance cell;
    for (int y = -beside; y < across + beside; ++y)
        for (int x = -beside; x < across + beside; ++x) {
            const Point2 st = low + Point2(x, y) * (width / Float(across - 1));
            const Vector2 slopes = PortalMap::ToSlopes(st);
            const Float density = PortalMap::SolidAngleDensity(slopes);
            if (!(density > 0) || !std::isfinite(density)) continue;  // at the map's border
            const Vector3 d = frame.FromLocal(Normalize(Vector3(slopes, 1)));
            const Float here = density * light.MeanRadiance(d);
            if (x >= 0 && y >= 0 && x < across && y < across) cell.mean += here;
            cell.max = std::max(cell.max, here);
        }
    cell.mean /= Float(across * across);
    return cell;
}

}  // namespace

PortalMap PortalMap::Integrate(const EnvironmentLight &light, const Frame &frame) {
    PortalMap map;
    const auto n = size_t(kSide);
    const Float width = 1 / Float(n);
    const auto corner = [&](size_t i) { return Point2(i % n, i / n) * width; };
    // At equal resolution, map pixels are at most about as wide as image pixels.
    const int across = std::max(2, (light.Resolution() + kSide - 1) / kSide) + 1;
    std::vector<CellRadiance> cells(n * n);
    ParallelForEach(int64_t(cells.size()), 8 * kSide,
                    [&](int64_t i) { cells[i] = EvaluateMapCell(light, frame, corner(i), width, across, 0); });

    double sum = 0;
    for (const CellRadiance &cell : cells) sum += double(cell.mean);
    std::vector<Float> weights(n * n);
    map.detailOf_.assign(n * n, 0);
    std::vector<size_t> divided;
    for (size_t i = 0; i < weights.size(); ++i) {
        Float max = 0;
        for (size_t y = std::max(i / n, size_t{1}) - 1; y < std::min(i / n + 2, n); ++y)
            for (size_t x = std::max(i % n, size_t{1}) - 1; x < std::min(i % n + 2, n); ++x)
                max = std::max(max, cells[y * n + x].max);
        const Float mean = cells[i].mean;
        weights[i] = std::max(mean, kBesidePixel * max);
        if (max > kContrast * mean && double(weights[i]) > kDividedShare * sum) {
            divided.push_back(i);
            map.detailOf_[i] = uint16_t(divided.size());
        }
    }
    map.details_.resize(divided.size());
    ParallelForEach(int64_t(divided.size()), 16, [&](int64_t d) {
        const Float part = width / kDetail;
        double total = 0;
        for (int k = 0; k < kDetail * kDetail; ++k) {
            const Point2 low = corner(divided[d]) + Point2(k % kDetail, k / kDetail) * part;
            const CellRadiance cell = EvaluateMapCell(light, frame, low, part, 3, 1);
            Float &value = map.details_[d][k];
            value = std::max(cell.mean, kBesidePart * cell.max);
            total += double(value);
        }
        weights[divided[d]] = Float(total / (kDetail * kDetail));
    });
    map.pixels_ = WindowedPiecewiseConstant2D(weights, kSide, kSide);
    return map;
}

Float PortalMap::DividedPixel::OfColumn(int x) const {
    Float sum = 0;
    for (int y = First(1); y <= Last(1); ++y) sum += std::max(Overlap(y, 1), Float(0)) * (*detail)[y * kDetail + x];
    return sum * std::max(Overlap(x, 0), Float(0));
}

Float PortalMap::DividedPixel::Sum() const {
    Float sum = 0;
    for (int x = First(0); x <= Last(0); ++x) sum += OfColumn(x);
    return sum;
}

std::optional<PortalMap::DividedPixel> PortalMap::DividedPixelAt(const Point2 &st, const Bounds2 &window,
                                                                 Point2 *pixel) const {
    if (details_.empty()) return {};
    const auto n = Float(kSide);
    const Point2i at = glm::clamp(Point2i(st * n), Point2i(0), Point2i(kSide - 1));
    const uint16_t detail = detailOf_[size_t(at.y) * kSide + at.x];
    if (detail == 0) return {};
    *pixel = Point2(at);
    const auto inParts = [&](const Point2 &p) {
        return glm::clamp((p * n - *pixel) * Float(kDetail), Point2(0), Point2(kDetail));
    };
    return DividedPixel{&details_[detail - 1], {inParts(window.low), inParts(window.high)}};
}

std::optional<PortalMap::Sample> PortalMap::Draw(const Point2 &u, const Bounds2 &window) const {
    Sample s{};
    const std::optional<Point2> st = pixels_.Sample(u, window, &s.pdf);
    if (!st) return {};
    s.st = *st;
    Point2 pixel;
    const std::optional<DividedPixel> part = DividedPixelAt(*st, window, &pixel);
    if (!part) return s;
    // The position within the pixel is uniform and selects the subpixel.
    const Vector2 extent = part->window.high - part->window.low;
    const Point2 in = (*st * Float(kSide) - pixel) * Float(kDetail);
    const Point2 v = glm::clamp((in - part->window.low) / extent, Point2(0), Point2(OneMinusEpsilon));
    const auto choose = [&](Float target, int axis, auto &&weightOf, Float *place) {
        int chosen = -1;
        Float before = 0, rest = 0;
        for (int i = part->First(axis); i <= part->Last(axis); ++i) {
            const Float weight = weightOf(i);
            if (!(weight > 0)) continue;
            chosen = i;
            rest = std::clamp((target - before) / weight, Float(0), OneMinusEpsilon);
            before += weight;
            if (target < before) break;
        }
        if (chosen >= 0) *place = std::max(part->window.low[axis], Float(chosen)) + rest * part->Overlap(chosen, axis);
        return chosen;
    };
    const Float sum = part->Sum();
    Point2 at;
    const int x = choose(
        v.x * sum, 0, [&](int i) { return part->OfColumn(i); }, &at.x);
    if (x < 0) return {};
    const auto inColumn = [&](int y) { return part->Overlap(y, 1) * (*part->detail)[y * kDetail + x]; };
    const int y = choose(v.y * part->OfColumn(x) / part->Overlap(x, 0), 1, inColumn, &at.y);
    if (y < 0) return {};
    s.pdf *= extent.x * extent.y * (*part->detail)[y * kDetail + x] / sum;
    s.st = glm::clamp((pixel + at / Float(kDetail)) / Float(kSide), window.low, window.high);
    return s.pdf > 0 ? std::optional(s) : std::nullopt;
}

Float PortalMap::Pdf(const Point2 &st, const Bounds2 &window) const {
    const Float pdf = pixels_.Pdf(st, window);
    Point2 pixel;
    const std::optional<DividedPixel> part = pdf > 0 ? DividedPixelAt(st, window, &pixel) : std::nullopt;
    if (!part) return pdf;
    const Point2 in = (st * Float(kSide) - pixel) * Float(kDetail);
    const Point2i at = glm::clamp(Point2i(in), Point2i(0), Point2i(kDetail - 1));
    const Vector2 extent = part->window.high - part->window.low;
    const Float sum = part->Sum();
    return sum > 0 ? pdf * extent.x * extent.y * (*part->detail)[at.y * kDetail + at.x] / sum : 0;
}

std::optional<Vector3> PortalMap::SampleDirection(const Point2 &u, const Bounds2 &window, Float *pdf) const {
    const std::optional<Sample> drawn = Draw(u, window);
    if (!drawn) return {};
    const Vector2 slopes = ToSlopes(drawn->st);
    const Float density = SolidAngleDensity(slopes);
    if (!std::isfinite(density)) return {};
    *pdf = drawn->pdf / density;
    return Normalize(Vector3(slopes, 1));
}

Float PortalMap::DirectionPdf(const Vector3 &local, const Bounds2 &window) const {
    if (!(local.z > 0)) return 0;
    const Vector2 slopes = Vector2(local) / local.z;
    const Float density = SolidAngleDensity(slopes);
    return std::isfinite(density) ? Pdf(FromSlopes(slopes), window) / density : 0;
}

size_t PortalMap::Bytes() const {
    return pixels_.Bytes() + detailOf_.capacity() * sizeof(uint16_t) + details_.capacity() * sizeof(Detail);
}

std::optional<std::string> Portal::Validate() const {
    const auto isOne = [](Float v) { return std::abs(v - 1) < Float(1e-3f); };
    const auto isNone = [](Float v) { return std::abs(v) < Float(1e-3f); };
    const auto &[x, y, z] = frame;
    if (!isOne(Dot(x, x)) || !isOne(Dot(y, y)) || !isOne(Dot(z, z)) || !isNone(Dot(x, y)) || !isNone(Dot(y, z)) ||
        !isNone(Dot(z, x)))
        return "the frame of a portal is not orthonormal";
    if (!(low.x < high.x && low.y < high.y && low.z == high.z) || !std::isfinite(Length(low) + Length(high)))
        return "a portal is not a rectangle";
    return {};
}

EnvironmentPortals::EnvironmentPortals(const EnvironmentLight &light, std::span<const Portal> portals)
    : light_(&light), portals_(portals.begin(), portals.end()) {
    PBRT_CHECK(portals.size() <= kMax);
    std::vector<Frame> frames;
    for (const Portal &portal : portals_) {
        const auto &[x, y, z] = portal.frame;
        const auto known = std::find_if(frames.begin(), frames.end(),
                                        [&](const Frame &f) { return f.x == x && f.y == y && f.z == z; });
        mapOf_.push_back(uint32_t(known - frames.begin()));
        if (known != frames.end()) continue;
        frames.push_back(portal.frame);
        maps_.push_back(PortalMap::Integrate(light, portal.frame));
    }
}

std::optional<Bounds2> Portal::WindowFrom(const Point3 &p) const {
    const Point3 at = frame.ToLocal(p);
    const Float height = low.z - at.z;
    if (!(height > 0)) return {};
    const Point2 from(at.x, at.y);
    return Bounds2{PortalMap::FromSlopes((Point2(low) - from) / height),
                   PortalMap::FromSlopes((Point2(high) - from) / height)};
}

Float EnvironmentPortals::IntegralAround(size_t k, const Point3 &p) const {
    const std::optional<Bounds2> window = portals_[k].WindowFrom(p);
    return window ? Map(k).IntegralAround(*window) : Float(0);
}

std::optional<EnvironmentPortals::Direction> EnvironmentPortals::Sample(size_t k, const Point3 &p,
                                                                        const Point2 &u) const {
    const std::optional<Bounds2> window = portals_[k].WindowFrom(p);
    if (!window) return {};
    Direction s;
    const std::optional<Vector3> local = Map(k).SampleDirection(u, *window, &s.pdf);
    if (!local) return {};
    s.wi = portals_[k].frame.FromLocal(*local);
    return RegionTowards(p, s.wi) == k ? std::optional(s) : std::nullopt;
}

Float EnvironmentPortals::Pdf(size_t k, const Point3 &p, const Vector3 &wi) const {
    if (RegionTowards(p, wi) != k) return 0;
    const std::optional<Bounds2> window = portals_[k].WindowFrom(p);
    return window ? Map(k).DirectionPdf(portals_[k].frame.ToLocal(wi), *window) : Float(0);
}

std::optional<LightLiSample> EnvironmentPortals::SampleLi(size_t region, const LightSampleContext &from,
                                                          const Point2 &u, const SampledWavelengths &lambda,
                                                          bool allowIncompletePdfs) const {
    if (region == Count()) {
        std::optional<LightLiSample> s = light_->SampleLi(from, u, lambda, allowIncompletePdfs, 0);
        return s && RegionTowards(from.p, s->wi) == region ? s : std::nullopt;
    }
    const std::optional<Direction> through = Sample(region, from.p, u);
    if (!through || !(through->pdf > 0)) return {};
    const SampledSpectrum L = light_->Le(from.p, through->wi, lambda);
    if (!L) return {};
    return LightLiSample{
        .L = L, .wi = through->wi, .pdf = through->pdf, .pLight = light_->PointOutside(from.p, through->wi)};
}

Float EnvironmentPortals::PdfLi(size_t region, const LightSampleContext &from, const Vector3 &wi,
                                bool allowIncompletePdfs) const {
    if (region < Count()) return Pdf(region, from.p, wi);
    return RegionTowards(from.p, wi) == region ? light_->PdfLi(from, wi, {}, {}, allowIncompletePdfs, 0) : Float(0);
}

size_t EnvironmentPortals::Bytes() const {
    size_t bytes = portals_.size() * (sizeof(Portal) + sizeof(uint32_t));
    for (const PortalMap &map : maps_) bytes += map.Bytes();
    return bytes;
}

std::optional<LightLiSample> LightComponent::SampleRegion(const LightSampleContext &from, const Point2 &u,
                                                          const SampledWavelengths &lambda,
                                                          bool allowIncompletePdfs) const {
    return region_.portals->SampleLi(region_.index, from, u, lambda, allowIncompletePdfs);
}

Float LightComponent::RegionPdf(const LightSampleContext &from, const Vector3 &wi, bool allowIncompletePdfs) const {
    return region_.portals->PdfLi(region_.index, from, wi, allowIncompletePdfs);
}

}  // namespace pbrt
