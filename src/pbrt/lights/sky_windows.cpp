#include "pbrt/lights/sky_windows.h"

#include <algorithm>

#include "pbrt/core/error.h"

namespace pbrt {

namespace {

bool AreEqual(const Frame &a, const Frame &b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

}  // namespace

std::optional<std::string> SkyWindow::Validate() const {
    const auto isOne = [](Float v) { return std::abs(v - 1) < Float(1e-3f); };
    const auto isNone = [](Float v) { return std::abs(v) < Float(1e-3f); };
    const auto &[x, y, z] = frame;
    if (!isOne(Dot(x, x)) || !isOne(Dot(y, y)) || !isOne(Dot(z, z)) || !isNone(Dot(x, y)) || !isNone(Dot(y, z)) ||
        !isNone(Dot(z, x)))
        return "the frame of a window is not orthonormal";
    if (!(low.x < high.x && low.y < high.y && low.z == high.z) || !std::isfinite(Length(low) + Length(high)))
        return "a window is no rectangle";
    return {};
}

SkyWindows::SkyWindows(const SkyLight &sky, std::span<const SkyWindow> windows)
    : windows_(windows.begin(), windows.end()) {
    PBRT_CHECK(windows.size() <= kMax);
    std::vector<Frame> frames;
    for (const SkyWindow &window : windows_) {
        const auto known =
            std::find_if(frames.begin(), frames.end(), [&](const Frame &f) { return AreEqual(f, window.frame); });
        mapOf_.push_back(static_cast<uint32_t>(known - frames.begin()));
        if (known != frames.end()) continue;
        frames.push_back(window.frame);
        maps_.emplace_back(sky, window.frame);
    }
}

std::optional<Bounds2> SkyWindows::SeenFrom(size_t k, const Point3 &p) const {
    const SkyWindow &window = windows_[k];
    const Point3 at = window.frame.ToLocal(p);
    const Float height = window.low.z - at.z;
    if (!(height > 0)) return {};
    const Point2 from(at.x, at.y);
    return Bounds2{SlopeMap::FromSlopes((Point2(window.low) - from) / height),
                   SlopeMap::FromSlopes((Point2(window.high) - from) / height)};
}

Float SkyWindows::Integral(size_t k, const Point3 &p) const {
    const std::optional<Bounds2> seen = SeenFrom(k, p);
    return seen ? Map(k).Integral(*seen) : Float(0);
}

std::optional<SkyWindows::Sample> SkyWindows::SampleWindow(size_t k, const Point3 &p, const Point2 &u) const {
    const std::optional<Bounds2> seen = SeenFrom(k, p);
    if (!seen) return {};
    const std::optional<SlopeMap::Sample> drawn = Map(k).Draw(u, *seen);
    if (!drawn) return {};
    const Vector2 slopes = SlopeMap::ToSlopes(drawn->st);
    const Float density = SlopeMap::SolidAngleDensity(slopes);
    const Vector3 wi = windows_[k].frame.FromLocal(Normalize(Vector3(slopes, 1)));
    if (!std::isfinite(density) || PartTowards(p, wi) != k) return {};
    return Sample{wi, drawn->pdf / density};
}

Float SkyWindows::Pdf(size_t k, const Point3 &p, const Vector3 &wi) const {
    if (PartTowards(p, wi) != k) return 0;
    const std::optional<Bounds2> seen = SeenFrom(k, p);
    const Vector3 local = windows_[k].frame.ToLocal(wi);
    if (!seen || !(local.z > 0)) return 0;
    const Vector2 slopes = Vector2(local) / local.z;
    const Float density = SlopeMap::SolidAngleDensity(slopes);
    return std::isfinite(density) ? Map(k).Pdf(SlopeMap::FromSlopes(slopes), *seen) / density : 0;
}

size_t SkyWindows::Bytes() const {
    size_t bytes = windows_.size() * (sizeof(SkyWindow) + sizeof(uint32_t));
    for (const SlopeMap &map : maps_) bytes += map.Bytes();
    return bytes;
}

}  // namespace pbrt
