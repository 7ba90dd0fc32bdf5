#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pbrt/lights/environment_light.h"
#include "pbrt/lights/portal_map.h"

namespace pbrt {

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
/// proportion to the radiance within the portal, by a PortalMap (Bitterli, Wyman and Pharr 2015, Portal-Masked
/// Environment Map Sampling); the remainder like the whole light. Refers to the light. Immutable.
class EnvironmentPortals {
  public:
    static constexpr size_t kMax = 15;

    /// At most kMax portals. Portals of equal frames share a map. Traces no rays; takes milliseconds per map.
    EnvironmentPortals(const EnvironmentLight &light, std::span<const Portal> portals);

    size_t Count() const { return portals_.size(); }
    size_t RegionCount() const { return portals_.size() + 1; }
    const Portal &operator[](size_t k) const { return portals_[k]; }
    /// Region of direction d from p: index of the first portal passed, or Count() for the remainder.
    size_t RegionTowards(const Point3 &p, const Vector3 &d) const {
        size_t k = 0;
        while (k < portals_.size() && !portals_[k].IsPassed(p, d)) ++k;
        return k;
    }
    /// Integral of EnvironmentLight::MeanRadiance over portal k from p.
    Float Integral(size_t k, const Point3 &p) const;
    /// An estimate of it, at least as large; a fraction of the cost.
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
