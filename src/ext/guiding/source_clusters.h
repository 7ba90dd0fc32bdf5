#pragma once
#include <array>
#include <span>
#include <vector>

#include "pbrt/math/bounds.h"
#include "pbrt/math/warps.h"

namespace ext {
using namespace pbrt;

/// A cluster of places that radiance comes from: a sphere. From a point it subtends a cone of directions, so an
/// estimate made at one point holds for its neighbours as well.
struct SourceCluster {
    Point3 p{};
    Float r2 = 0;        ///< square of the radius
    Float radiance = 0;  ///< mean over the vertices that were recorded, also those from which it is not visible

    bool Contains(const Point3 &q) const { return LengthSquared(p - q) <= r2; }
};

/// The radiance that one scattering event received.
struct RadianceSample {
    static constexpr uint32_t kNone = ~uint32_t{0};
    Point3 target{};
    double radiance = 0;
    double perPdf = 0;  ///< one over the density of its direction (solid angle)
    /// Set by MakeSourceClusters: mean over the samples near the target, also those of 0.
    double meanRadiance = 0;
    uint32_t number = 0;       ///< for the caller
    uint32_t cluster = kNone;  ///< set by MakeSourceClusters: index of the cluster that contains the target
};

/// Clusters that minimise the second moment of the mean radiance when directions are drawn from all of them, found by
/// merging small ones greedily; at most kMaxSourceClusters. `samples`: of `bounces` scattering events, reordered; most
/// may be 0. `from`: vertices of some of these events.
///
/// The variance of single samples about the mean is left out: most of it comes from later events that sample light
/// badly, and vanishes when those are guided as well.
inline constexpr size_t kMaxSourceClusters = 64;
std::vector<SourceCluster> MakeSourceClusters(std::span<RadianceSample> samples, std::span<const Point3> from,
                                              size_t bounces);

/// A number for each cluster; 0 behind the last one.
using PerSourceCluster = std::array<Float, kMaxSourceClusters>;

/// Clusters as structure of arrays.
struct SourceClusters {
    SourceClusters() = default;
    explicit SourceClusters(std::span<const SourceCluster> clusters);

    size_t count = 0;
    PerSourceCluster x{}, y{}, z{}, r{};  ///< centre and radius
};

/// The solid angle of a cluster's cone times a bound of its cosine with the shading normal: its weight in
/// GuideDirections.
Float SolidAngleOf(const SourceCluster &cluster, const Point3 &p, const Vector3 &n, bool bothSides);

/// Distribution of directions at a vertex: a mixture of uniform cones, one for each cluster, weighted by its radiance
/// times a bound of the cosine with the shading normal. Clusters that contain the vertex or lie below its surface are
/// left out.
class GuideDirections {
  public:
    /// `radiances`: of the clusters from p, 0 for occluded ones; only ratios matter. `n`: the shading
    /// normal (unit) on the side that light is scattered to; `bothSides`: light is scattered to both.
    void Prepare(const SourceClusters &clusters, const PerSourceCluster &radiances, const Point3 &p, const Vector3 &n,
                 bool bothSides);
    /// False if no direction has a density.
    bool IsUsable() const { return isUsable_; }
    /// A direction; it may lie below the surface.
    Vector3 Sample(const Point2 &u) const;
    /// By solid angle; 0 if the directions are not usable.
    Float Pdf(const Vector3 &w) const;

  private:
    bool isUsable_ = false;
    size_t end_ = 0;                          ///< behind the last cone, a multiple of the SIMD width
    alignas(64) PerSourceCluster x_, y_, z_;  ///< unit vectors to the middle of the cones
    PerSourceCluster cosine_;                 ///< of the half angles of the cones
    PerSourceCluster density_;                ///< in the cones (solid angle); 0: left out
    PerSourceCluster probability_;            ///< of the cones
};

}  // namespace ext
