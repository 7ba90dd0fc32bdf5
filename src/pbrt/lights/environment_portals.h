#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pbrt/lights/environment_light.h"
#include "pbrt/math/distributions.h"
#include "pbrt/math/frame.h"

namespace pbrt {

/// Radiance of an environment light over the half-space z > 0 of a frame. A rectangle with sides along x and y is an
/// axis-aligned window on the map, from any point before it. Map coordinates of a direction (x, y, z) are its slopes a
/// = x / z and b = y / z, mapped to (0, 1) by (1 + a / (1 + |a|)) / 2. (Bitterli, Wyman and Pharr 2015, Portal-Masked
/// Environment Map Sampling, use the arc tangent; this avoids trigonometry.)
///
/// Within a window, directions are sampled in proportion to the mean radiance of the map's pixels. Bright high-contrast
/// pixels are subdivided once: the rim of a sun would be noisy otherwise.
class PortalMap {
  public:
    /// Integrates the light's mean radiance over the map's 128 x 128 pixels, on all threads.
    static PortalMap Integrate(const EnvironmentLight &light, const Frame &frame);

    static Float FromSlope(Float a) { return Float(0.5) + Float(0.5) * a / (1 + std::abs(a)); }
    static Float ToSlope(Float s) {
        const Float v = 2 * s - 1;
        return v / (1 - std::abs(v));
    }
    static Point2 FromSlopes(const Vector2 &a) { return {FromSlope(a.x), FromSlope(a.y)}; }
    static Vector2 ToSlopes(const Point2 &st) { return {ToSlope(st.x), ToSlope(st.y)}; }
    /// Solid angle per map area.
    static Float SolidAngleDensity(const Vector2 &a) {
        const Float x = 1 + std::abs(a.x), y = 1 + std::abs(a.y), z2 = 1 / (1 + a.x * a.x + a.y * a.y);
        return 4 * Sqr(x * y) * z2 * std::sqrt(z2);
    }

    /// Integral over a window of mean radiance (EnvironmentLight::MeanRadiance) and solid angle.
    Float Integral(const Bounds2 &window) const { return Float(pixels_.Integral(window)); }
    /// The same over a slightly larger window; a fraction of the cost.
    Float IntegralAround(const Bounds2 &window) const { return pixels_.IntegralAround(window); }
    /// Samples a direction (unit, in the frame) in the window; density by solid angle. Empty if it has no radiance.
    std::optional<Vector3> SampleDirection(const Point2 &u, const Bounds2 &window, Float *pdf) const;
    /// Density of SampleDirection; 0 outside the window. `local`: in the frame.
    Float DirectionPdf(const Vector3 &local, const Bounds2 &window) const;
    size_t Bytes() const;

  private:
    PortalMap() = default;
    struct Sample {
        Point2 st;
        Float pdf;  ///< by map area
    };
    std::optional<Sample> Draw(const Point2 &u, const Bounds2 &window) const;
    Float Pdf(const Point2 &st, const Bounds2 &window) const;

    static constexpr int kDetail = 8;
    /// Subpixel values; their mean is the pixel's value.
    using Detail = std::array<Float, kDetail * kDetail>;
    /// A subdivided pixel, clipped to a window.
    struct DividedPixel {
        const Detail *detail;
        Bounds2 window;  ///< in subpixel units
        Float Overlap(int part, int axis) const {
            return std::min(window.high[axis], Float(part + 1)) - std::max(window.low[axis], Float(part));
        }
        int First(int axis) const { return std::clamp(int(window.low[axis]), 0, kDetail - 1); }
        int Last(int axis) const { return std::clamp(int(window.high[axis]), 0, kDetail - 1); }
        Float OfColumn(int x) const;
        Float Sum() const;
    };
    /// Empty if the pixel is not subdivided. *pixel: its position.
    std::optional<DividedPixel> DividedPixelAt(const Point2 &st, const Bounds2 &window, Point2 *pixel) const;

    WindowedPiecewiseConstant2D pixels_;
    std::vector<uint16_t> detailOf_;  ///< per pixel: index in details_ + 1; 0: none
    std::vector<Detail> details_;
};

/// Rectangle through which an environment light is visible.
struct Portal {
    Frame frame;           ///< x and y along the sides, z outward
    Point3 low{}, high{};  ///< opposite corners in frame coordinates, low.z = high.z

    /// Empty if valid, else the error.
    std::optional<std::string> Validate() const;

    Point3 Middle() const { return frame.FromLocal((low + high) * Float(0.5)); }

    /// True if p is on the inner side of the portal's plane.
    bool IsBefore(const Point3 &p) const { return low.z > Dot(p, frame.z); }
    /// True if a ray from p in direction d passes the portal outward.
    bool IsPassed(const Point3 &p, const Vector3 &d) const {
        const Float height = low.z - Dot(p, frame.z), rise = Dot(d, frame.z);
        if (!(height > 0) || !(rise > 0)) return false;
        const Vector3 at = p + d * (height / rise);
        const Float x = Dot(at, frame.x), y = Dot(at, frame.y);
        return x >= low.x && y >= low.y && x <= high.x && y <= high.y;
    }
    /// The portal on its PortalMap from p; empty behind it.
    std::optional<Bounds2> WindowFrom(const Point3 &p) const;
};

/// Partitions the directions of an environment light, from a point, into regions: visible through the first portal,
/// through the second but not the first, and so on; the last region is the remainder. Portal regions are sampled in
/// proportion to the radiance within the portal, by a PortalMap; the remainder like the light itself. Refers to the
/// light. Immutable.
class EnvironmentPortals {
  public:
    static constexpr size_t kMax = 15;

    /// At most kMax portals. Portals of equal frames share a map. Traces no rays; takes milliseconds per map.
    EnvironmentPortals(const EnvironmentLight &light, std::span<const Portal> portals);

    size_t Count() const { return portals_.size(); }
    const Portal &operator[](size_t k) const { return portals_[k]; }
    /// Region of direction d from p: index of the first portal passed, or Count() for the remainder.
    size_t RegionTowards(const Point3 &p, const Vector3 &d) const {
        size_t k = 0;
        while (k < portals_.size() && !portals_[k].IsPassed(p, d)) ++k;
        return k;
    }
    /// PortalMap::IntegralAround portal k as seen from p; 0 behind it.
    Float IntegralAround(size_t k, const Point3 &p) const;

    struct Direction {
        Vector3 wi;
        Float pdf;  ///< solid angle
    };
    /// Samples a direction through portal k; empty where its radiance is zero or an earlier portal covers it.
    std::optional<Direction> Sample(size_t k, const Point3 &p, const Point2 &u) const;
    /// Density of Sample (solid angle); 0 outside region k.
    Float Pdf(size_t k, const Point3 &p, const Vector3 &wi) const;

    /// Light::SampleLi and PdfLi (solid angle) of a region.
    std::optional<LightLiSample> SampleLi(size_t region, const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool allowIncompletePdfs) const;
    Float PdfLi(size_t region, const LightSampleContext &from, const Vector3 &wi, bool allowIncompletePdfs) const;
    /// Map of the half-space behind portal k.
    const PortalMap &Map(size_t k) const { return maps_[mapOf_[k]]; }
    size_t Bytes() const;

  private:
    const EnvironmentLight *light_;
    std::vector<Portal> portals_;
    std::vector<uint32_t> mapOf_;
    std::vector<PortalMap> maps_;
};

}  // namespace pbrt
