#pragma once
#include <array>
#include <span>
#include <vector>

#include "pbrt/math/bounds.h"
#include "pbrt/math/warps.h"

namespace pbrt {

/// A place that shines, as bounces found it: a ball. Seen from a point, it covers a cone of directions, so what was
/// learned from one point holds for its neighbours as well.
struct GuideTarget {
    Point3 p{};
    Float r2 = 0;        ///< square of the radius
    Float radiance = 0;  ///< its mean over places that bounces left from, also those that do not see it

    bool Contains(const Point3 &q) const { return LengthSquared(p - q) <= r2; }
};

/// What a bounce found where it went.
struct TargetFind {
    static constexpr uint32_t kNone = ~uint32_t{0};
    Point3 target{};
    double radiance = 0;
    double perPdf = 0;  ///< one over the density of the bounce (solid angle)
    /// Set by MakeGuideTargets: the mean over finds, those of nothing included, near the target.
    double meanRadiance = 0;
    uint32_t number = 0;    ///< of the caller
    uint32_t ball = kNone;  ///< set by MakeGuideTargets: the number of the ball that the target is in
};

/// The balls for which choosing directions by all of them makes the second moment of the mean radiance least, as far
/// as merging small ones leads; at most kMostGuideTargets. `finds`: what `bounces` bounces found, reordered; most of
/// them may have found nothing. `from`: places that some bounces left from.
///
/// The mean, not what the finds scatter about it: most of that comes from later bounces that find light rarely, and
/// goes when those are guided as well.
inline constexpr size_t kMostGuideTargets = 64;
std::vector<GuideTarget> MakeGuideTargets(std::span<TargetFind> finds, std::span<const Point3> from, size_t bounces);

/// A number for each ball; 0 behind the last one.
using PerGuideTarget = std::array<Float, kMostGuideTargets>;

/// The balls side by side.
struct GuideTargets {
    GuideTargets() = default;
    explicit GuideTargets(std::span<const GuideTarget> targets);

    size_t count = 0;
    PerGuideTarget x{}, y{}, z{}, r{};  ///< middle and radius
};

/// The solid angle of a ball's cone times a bound of its cosine with the shading normal, as GuideDirections weighs it.
Float SolidAngleOf(const GuideTarget &target, const Point3 &p, const Vector3 &n, bool bothSides);

/// The density of directions at a vertex: constant in the cone of each target, in proportion to its radiance times a
/// bound of the cosine with the shading normal, and added up where cones overlap. Targets that the vertex lies in or
/// does not face have no part.
class GuideDirections {
  public:
    /// `radiances`: of the balls as seen from p, 0 for those that are hidden; only ratios matter. `n`: the shading
    /// normal (unit) on the side that light is scattered to; `bothSides`: light is scattered to both.
    void Prepare(const GuideTargets &targets, const PerGuideTarget &radiances, const Point3 &p, const Vector3 &n,
                 bool bothSides);
    /// False if no direction has a density.
    bool IsUsable() const { return isUsable_; }
    /// A direction; it may lie below the surface.
    Vector3 Sample(const Point2 &u) const;
    /// By solid angle; 0 if the directions are not usable.
    Float Pdf(const Vector3 &w) const;

  private:
    bool isUsable_ = false;
    size_t end_ = 0;                        ///< behind the last cone, a multiple of how many are treated at once
    alignas(64) PerGuideTarget x_, y_, z_;  ///< unit vectors to the middle of the cones
    PerGuideTarget cosine_;                 ///< of the half angles of the cones
    PerGuideTarget density_;                ///< in the cones; 0: no part
    PerGuideTarget share_;                  ///< probability of the cones
};

}  // namespace pbrt
