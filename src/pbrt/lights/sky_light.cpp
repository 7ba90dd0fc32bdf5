#include "pbrt/lights/sky_light.h"

#include <algorithm>

namespace pbrt {

std::shared_ptr<const uint32_t> SkyLight::AddWindows(std::shared_ptr<const SkyWindows> windows) const {
    const std::lock_guard lock(sets_->mutex);
    const auto place = std::find(sets_->windows.begin(), sets_->windows.end(), nullptr);
    if (place == sets_->windows.end()) return nullptr;
    *place = std::move(windows);
    const auto remove = [sets = sets_](const uint32_t *set) {
        const std::lock_guard removing(sets->mutex);
        sets->windows[*set] = nullptr;
        delete set;
    };
    return {new uint32_t(static_cast<uint32_t>(place - sets_->windows.begin())), remove};
}

std::optional<LightLiSample> SkyLight::SampleLi(const LightSampleContext &from, const Point2 &u,
                                                const SampledWavelengths &lambda, bool allowIncompletePdfs,
                                                uint32_t part) const {
    std::optional<LightLiSample> s;
    if (part == 0) {
        s = SampleWhole(u, lambda, allowIncompletePdfs);
    } else {
        const SkyWindows &windows = WindowsOf(part);
        const size_t place = SkyPart::PlaceOf(part);
        if (place < windows.Count()) {
            const std::optional<SkyWindows::Sample> through = windows.SampleWindow(place, from.p, u);
            if (!through || !(through->pdf > 0)) return {};
            s.emplace();
            s->L = Le(from.p, through->wi, lambda);
            if (!s->L) return {};
            s->wi = through->wi;
            s->pdf = through->pdf;
        } else {
            s = SampleWhole(u, lambda, allowIncompletePdfs);
            if (s && windows.PartTowards(from.p, s->wi) < windows.Count()) return {};
        }
    }
    if (s) s->pLight = Beyond(from.p, s->wi);
    return s;
}

Float SkyLight::PdfLi(const LightSampleContext &from, const Vector3 &wi, const Point3 &, const Normal3 &,
                      bool allowIncompletePdfs, uint32_t part) const {
    if (part == 0) return PdfOfWhole(wi, allowIncompletePdfs);
    const SkyWindows &windows = WindowsOf(part);
    const size_t place = SkyPart::PlaceOf(part);
    if (place < windows.Count()) return windows.Pdf(place, from.p, wi);
    return windows.PartTowards(from.p, wi) < windows.Count() ? 0 : PdfOfWhole(wi, allowIncompletePdfs);
}

}  // namespace pbrt
