#pragma once
#include <array>
#include <span>
#include <vector>

#include "pbrt/math/bounds.h"
#include "pbrt/math/warps.h"

namespace ext {
using namespace pbrt;

/// Bounding sphere of positions that radiance comes from. It subtends a cone from any point, so estimates made at one
/// point hold for its neighbours.
struct SourceCluster {
    Point3 p{};
    Float r2 = 0;        ///< squared radius
    Float radiance = 0;  ///< mean over recorded vertices, including those from which it is occluded

    bool Contains(const Point3 &q) const { return LengthSquared(p - q) <= r2; }
};

struct RadianceSample {
    static constexpr uint32_t kNone = ~uint32_t{0};
    Point3 target{};
    double radiance = 0;
    double perPdf = 0;  ///< 1 / density of its direction (solid angle)
    /// Set by MakeSourceClusters: mean over samples near the target, including zeros.
    double meanRadiance = 0;
    uint32_t number = 0;       ///< caller's index
    uint32_t cluster = kNone;  ///< set by MakeSourceClusters: index of the cluster that contains the target
};

/// Clusters that minimize the second moment of the mean radiance when directions are drawn from all of them, by greedy
/// merging of small ones; at most kMaxSourceClusters. `samples`: of `bounces` scattering events, reordered; most may be
/// 0. `from`: vertices of some of these events.
///
/// The variance of samples about the mean is excluded: most of it stems from poor light sampling at later events, and
/// vanishes when those are guided too.
inline constexpr size_t kMaxSourceClusters = 64;
std::vector<SourceCluster> MakeSourceClusters(std::span<RadianceSample> samples, std::span<const Point3> from,
                                              size_t bounces);

/// One value per cluster; 0 past the last.
using PerSourceCluster = std::array<Float, kMaxSourceClusters>;

struct SourceClusters {
    SourceClusters() = default;
    explicit SourceClusters(std::span<const SourceCluster> clusters);

    size_t count = 0;
    PerSourceCluster x{}, y{}, z{}, r{};  ///< centre and radius
};

/// Solid angle of the cluster's cone times a bound of its cosine with the shading normal: its weight in
/// GuideDirections.
Float SolidAngleOf(const SourceCluster &cluster, const Point3 &p, const Vector3 &n, bool bothSides);

/// Direction distribution at a vertex: a mixture of uniform cones, one per cluster, weighted by radiance times a bound
/// of the cosine with the shading normal. Clusters that contain the vertex or lie below its surface are excluded.
class GuideDirections {
  public:
    /// `radiances`: of the clusters from p, 0 if occluded; only ratios matter. `n`: shading normal (unit) on the side
    /// that scatters light; `bothSides`: both sides do.
    void Prepare(const SourceClusters &clusters, const PerSourceCluster &radiances, const Point3 &p, const Vector3 &n,
                 bool bothSides);
    /// False if all densities are 0.
    bool IsUsable() const { return isUsable_; }
    /// Samples a direction, possibly below the surface.
    Vector3 Sample(const Point2 &u) const;
    /// Density (solid angle); 0 if not usable.
    Float Pdf(const Vector3 &w) const;

  private:
    bool isUsable_ = false;
    size_t end_ = 0;                          ///< past the last cone, a multiple of the SIMD width
    alignas(64) PerSourceCluster x_, y_, z_;  ///< cone axes (unit)
    PerSourceCluster cosine_;                 ///< of the cones' half angles
    PerSourceCluster density_;                ///< within the cone (solid angle); 0: excluded
    PerSourceCluster probability_;            ///< of the cone (discrete)
};

}  // namespace ext
