#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pbrt/lights/slope_map.h"

namespace pbrt {

/// A rectangle that a sky may be seen through.
struct SkyWindow {
    Frame frame;           ///< x and y along the sides, z to the outside
    Point3 low{}, high{};  ///< opposite corners, in coordinates of the frame, with low.z = high.z

    /// Empty, or what is wrong with a window that was read from a file.
    std::optional<std::string> Validate() const;

    Point3 Middle() const { return frame.FromLocal((low + high) * Float(0.5)); }

    /// Whether p is on the inner side of its plane.
    bool IsBefore(const Point3 &p) const { return low.z > Dot(p, frame.z); }
    /// Whether a ray from p in direction d passes it outward.
    bool IsPassed(const Point3 &p, const Vector3 &d) const {
        const Float height = low.z - Dot(p, frame.z), rise = Dot(d, frame.z);
        if (!(height > 0) || !(rise > 0)) return false;
        const Vector3 at = p + d * (height / rise);
        const Float x = Dot(at, frame.x), y = Dot(at, frame.y);
        return x >= low.x && y >= low.y && x <= high.x && y <= high.y;
    }
};

/// A few windows that light sampling divides one sky by, as seen from a point: what is seen through the first of them,
/// through the second and not the first, and so on; and the rest, which is seen through none. Window k is sampled by
/// a map of the sky behind it (SlopeMap), in proportion to the radiance within the window as seen from the point
/// (Bitterli, Wyman and Pharr 2015, Portal-Masked Environment Map Sampling).
class SkyWindows {
  public:
    static constexpr size_t kMax = 15;

    /// At most kMax windows. Windows of equal frames share a map.
    SkyWindows(const SkyLight &sky, std::span<const SkyWindow> windows);

    size_t Count() const { return windows_.size(); }
    const SkyWindow &operator[](size_t k) const { return windows_[k]; }
    /// The part of the sky in direction d from p: the first window that is passed, or Count(), the rest.
    size_t PartTowards(const Point3 &p, const Vector3 &d) const {
        size_t k = 0;
        while (k < windows_.size() && !windows_[k].IsPassed(p, d)) ++k;
        return k;
    }
    /// The integral of the sky's mean radiance (SkyLight::MeanRadiance) over the window as seen from p.
    Float Integral(size_t k, const Point3 &p) const;

    struct Sample {
        Vector3 wi;
        Float pdf;  ///< solid angle
    };
    /// A direction through window k; empty where it shows nothing, or what a window before it shows.
    std::optional<Sample> SampleWindow(size_t k, const Point3 &p, const Point2 &u) const;
    /// 0 for directions that are not of part k.
    Float Pdf(size_t k, const Point3 &p, const Vector3 &wi) const;
    size_t Bytes() const;

  private:
    const SlopeMap &Map(size_t k) const { return maps_[mapOf_[k]]; }
    /// Window k on the map, as seen from p; empty behind it.
    std::optional<Bounds2> SeenFrom(size_t k, const Point3 &p) const;

    std::vector<SkyWindow> windows_;
    std::vector<uint32_t> mapOf_;
    std::vector<SlopeMap> maps_;
};

/// The numbers of the parts of a sky: 0 is the whole, then come the parts of every set of windows that a light sampler
/// has made known (SkyLight::AddWindows).
struct SkyPart {
    static constexpr uint32_t kSets = 64, kPerSet = SkyWindows::kMax + 1;
    static constexpr uint32_t kCount = 1 + kSets * kPerSet;

    static uint32_t FirstOf(uint32_t set) { return 1 + set * kPerSet; }
    /// Of a number above 0.
    static uint32_t SetOf(uint32_t number) { return (number - 1) / kPerSet; }
    /// Of SkyWindows: a window, or the rest.
    static uint32_t PlaceOf(uint32_t number) { return (number - 1) % kPerSet; }
};

}  // namespace pbrt
