#include "pbrt/lights/environment_portals.h"

#include <algorithm>

#include "pbrt/core/error.h"

namespace pbrt {
namespace {

bool AreEqual(const Frame &a, const Frame &b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

}  // namespace

std::optional<std::string> Portal::Validate() const {
    const auto isOne = [](Float v) { return std::abs(v - 1) < Float(1e-3f); };
    const auto isNone = [](Float v) { return std::abs(v) < Float(1e-3f); };
    const auto &[x, y, z] = frame;
    if (!isOne(Dot(x, x)) || !isOne(Dot(y, y)) || !isOne(Dot(z, z)) || !isNone(Dot(x, y)) || !isNone(Dot(y, z)) ||
        !isNone(Dot(z, x)))
        return "the frame of a portal is not orthonormal";
    if (!(low.x < high.x && low.y < high.y && low.z == high.z) || !std::isfinite(Length(low) + Length(high)))
        return "a portal is no rectangle";
    return {};
}

EnvironmentPortals::EnvironmentPortals(const EnvironmentLight &light, std::span<const Portal> portals)
    : light_(&light), portals_(portals.begin(), portals.end()) {
    PBRT_CHECK(portals.size() <= kMax);
    std::vector<Frame> frames;
    for (const Portal &portal : portals_) {
        const auto known =
            std::find_if(frames.begin(), frames.end(), [&](const Frame &f) { return AreEqual(f, portal.frame); });
        mapOf_.push_back(uint32_t(known - frames.begin()));
        if (known != frames.end()) continue;
        frames.push_back(portal.frame);
        maps_.emplace_back(light, portal.frame);
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

Float EnvironmentPortals::Integral(size_t k, const Point3 &p) const {
    const std::optional<Bounds2> window = portals_[k].WindowFrom(p);
    return window ? Map(k).Integral(*window) : Float(0);
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
    return LightLiSample{.L = L, .wi = through->wi, .pdf = through->pdf, .pLight = light_->Beyond(from.p, through->wi)};
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
