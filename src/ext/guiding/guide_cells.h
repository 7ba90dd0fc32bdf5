#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "ext/guiding/point_tree.h"
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
    double perPdf = 0;         ///< 1 / density of its direction (solid angle)
    double meanRadiance = 0;   ///< set by MakeSourceClusters: mean over samples near the target, including zeros
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

using PerSourceCluster = std::array<Float, kMaxSourceClusters>;  ///< one value per cluster; 0 past the last

struct SourceClusters {
    SourceClusters() = default;
    explicit SourceClusters(std::span<const SourceCluster> clusters);

    size_t count = 0;
    alignas(64) PerSourceCluster x{}, y{}, z{}, r{};  ///< centre and radius
};

/// Solid angle of the cluster's cone times a bound of its cosine with the shading normal: its weight in
/// GuideDirections.
Float SolidAngleOf(const SourceCluster &cluster, const Point3 &p, const Vector3 &n, bool bothSides);

/// Direction distribution at a vertex: a mixture of uniform cones, one per cluster, weighted by radiance times a bound
/// of the cosine with the shading normal. Clusters that contain the vertex or lie below its surface are excluded.
class GuideDirections {
  public:
    static constexpr int kLanes = 8;  ///< cones evaluated together
    /// `radiances`: of the clusters from p, 0 if occluded; only ratios matter. `n`: shading normal (unit) on the side
    /// that scatters light; `bothSides`: both sides do.
    void Prepare(const SourceClusters &clusters, const PerSourceCluster &radiances, const Point3 &p, const Vector3 &n,
                 bool bothSides);
    bool IsUsable() const { return end_ > 0; }  ///< false if all densities are 0
    /// Samples a direction, possibly below the surface.
    Vector3 Sample(const Point2 &u) const;
    Float Pdf(const Vector3 &w) const;  ///< density (solid angle); 0 if not usable

  private:
    size_t end_ = 0;                          ///< past the last cone, a multiple of the SIMD width; 0 if not usable
    Float total_ = 0, perTotal_ = 0;          ///< sum of weightOfCone_; its reciprocal, or 0 if not usable
    alignas(64) PerSourceCluster x_, y_, z_;  ///< cone axes (unit)
    PerSourceCluster cosine_;                 ///< of the cones' half angles
    PerSourceCluster weight_;                 ///< `total_` times the density in the cone (solid angle); 0: excluded
    PerSourceCluster weightOfCone_;           ///< `total_` times the probability of the cone (discrete)
    alignas(32) std::array<Float, kLanes> laneSums_;  ///< of weightOfCone_ over cones of equal index modulo kLanes
};

/// Record of one scattering event.
struct GuideRecord {
    Point3 p{};
    Point3 target{};             ///< position that its radiance comes from, unfolded through specular vertices
    Vector3 normal{};            ///< see GuideDirections::Prepare
    Vector3 wi{};                ///< sampled direction
    Float radiance = 0;          ///< incident from wi, times its MIS weight; mean over wavelengths
    Float contribution = 0;      ///< to the sample, divided by the throughput `beta`; mean over wavelengths
    Float pdf = 0;               ///< density of wi (solid angle); 0: empty slot
    Float bsdfPdf = 0;           ///< density of BSDF sampling alone (solid angle)
    Float beta = 0;              ///< throughput at p, mean over wavelengths
    bool bothSides = false;      ///< see GuideDirections::Prepare
    bool isGlossy = false;       ///< the BSDF has a glossy lobe
    bool isOfFirstHalf = false;  ///< cross-validation: each half of the paths validates the other's estimate
    bool unused = false;         ///< explicit padding: saved records are byte-identical

    bool IsEmpty() const { return !(pdf > 0); }
    void Visit(auto &archive) {
        archive(p, target, normal, wi, radiance, contribution, pdf, bsdfPdf, beta, bothSides, isGlossy, isOfFirstHalf,
                unused);
    }
    std::optional<std::string> Validate() const {
        const auto isFinite = [](const Vector3 &v) { return std::isfinite(v.x + v.y + v.z); };
        const bool isValid = isFinite(p) && isFinite(target) && isFinite(normal) && isFinite(wi) && pdf > 0 &&
                             std::isfinite(pdf) && bsdfPdf >= 0 && std::isfinite(bsdfPdf) && beta >= 0 &&
                             std::isfinite(beta) && std::isfinite(radiance) && std::isfinite(contribution);
        return isValid ? std::nullopt : std::optional("a record is not finite");
    }
};

/// Source clusters of a scene and a spatial tree whose cells store the clusters' radiance and the guiding probability.
/// The latter minimizes the second moment of the contributions, by cross-validation of two halves of the records; 0
/// where nothing is gained.
class GuideCells {
  public:
    void Learn(std::span<const GuideRecord> records, Float largestProbability);

    /// Cluster radiances at p and the guiding probability; null: probability 0. `importance`: squared product of
    /// throughput and PathRoulette::PixelImportance, the path cost per unit of variance (EARS). Guiding is used only if
    /// it saves more than it costs.
    const PerSourceCluster *At(const Point3 &p, bool isGlossy, Float importance, Float *probability) const {
        if (!MayGuide(importance)) return nullptr;
        const uint32_t number = tree_.LeafOf(p);
        const Leaf &leaf = leaves_[number];
        const size_t kind = isGlossy ? 1 : 0;
        *probability = leaf.probability[kind];
        return importance * leaf.gain[kind] > kGuidedCost ? &radiances_[number].perCluster : nullptr;
    }
    const SourceClusters &Clusters() const { return sideBySide_; }
    /// Path cost, in vertices, that guiding saves at p, net of its own; 0 where At returns null.
    Float SavedAt(const Point3 &p, bool isGlossy, Float importance) const {
        if (!MayGuide(importance)) return 0;
        return std::max(Float(0), importance * leaves_[tree_.LeafOf(p)].gain[isGlossy ? 1 : 0] - kGuidedCost);
    }
    bool Guide() const { return largestGain_ > 0; }
    /// False if At returns null everywhere.
    bool MayGuide(Float importance) const { return importance * largestGain_ > kGuidedCost; }
    /// Radiance of the brightest cluster that contains p, relative to the maximum over clusters; 0: none contains p.
    Float ShinesAt(const Point3 &p) const {
        Float radiance = 0, brightest = 0;
        for (const SourceCluster &target : clusters_) {
            brightest = std::max(brightest, target.radiance);
            if (target.Contains(p)) radiance = std::max(radiance, target.radiance);
        }
        return radiance > 0 ? radiance / brightest : 0;
    }
    void Clear() { *this = {}; }
    /// After loading, LeavesChanged completes the members that are not saved.
    void Visit(auto &archive) { archive(leaves_, radiances_, clusters_, tree_); }
    std::optional<std::string> Validate() const {
        if (clusters_.size() > kMaxSourceClusters) return "it has too many clusters";
        if (std::optional<std::string> fault = tree_.ValidateFor(1, leaves_.size())) return fault;
        const auto isNumber = [](Float v) { return v >= 0 && std::isfinite(v); };
        for (const Leaf &leaf : leaves_)
            for (const size_t kind : {0, 1})
                if (!(leaf.probability[kind] >= 0 && leaf.probability[kind] < 1) || !isNumber(leaf.gain[kind]))
                    return "a cell of the guide has a wrong probability";
        if (radiances_.size() != leaves_.size()) return "a cell of the guide has no radiances";
        for (const LeafRadiances &radiances : radiances_)
            if (!std::ranges::all_of(radiances.perCluster, isNumber))
                return "a cell of the guide has a radiance that is not a finite number";
        for (const SourceCluster &t : clusters_)
            if (!std::isfinite(t.p.x + t.p.y + t.p.z) || !isNumber(t.r2) || !isNumber(t.radiance))
                return "a cluster is not finite";
        return tree_.IsEmpty() != leaves_.empty() ? std::optional("guide cells without a tree") : std::nullopt;
    }
    void LeavesChanged() {
        sideBySide_ = SourceClusters(clusters_);
        largestGain_ = 0;
        for (const Leaf &leaf : leaves_) largestGain_ = std::max({largestGain_, leaf.gain[0], leaf.gain[1]});
    }

    size_t Cells() const { return leaves_.size(); }
    size_t GuidingCells() const { return std::ranges::count_if(leaves_, &Leaf::Guides); }
    double MeanProbability() const {
        double sum = 0;
        for (const Leaf &leaf : leaves_) sum += double(std::max(leaf.probability[0], leaf.probability[1]));
        return leaves_.empty() ? 0 : sum / double(leaves_.size());
    }
    size_t Bytes() const {
        return tree_.Bytes() + leaves_.size() * (sizeof(Leaf) + sizeof(LeafRadiances)) +
               clusters_.size() * sizeof(SourceCluster);
    }

  private:
    static constexpr Float kGuidedCost = 0.15f;  ///< additional cost of a guided direction, in vertices
    /// Apart from LeafRadiances, as lookups that guide nothing read no radiances.
    struct Leaf {
        // Index 0: BSDFs without a glossy lobe; 1: with one.
        Float probability[2] = {};  ///< guiding probability
        Float gain[2] = {};         ///< reduction of the contribution's second moment by guiding

        bool Guides() const { return gain[0] > 0 || gain[1] > 0; }
    };
    struct alignas(64) LeafRadiances {
        PerSourceCluster perCluster{};  ///< only ratios matter
    };
    friend class GuideCellsBuilder;

    PointTree tree_;
    std::vector<Leaf> leaves_;
    std::vector<LeafRadiances> radiances_;  ///< one per leaf
    std::vector<SourceCluster> clusters_;
    SourceClusters sideBySide_;  ///< clusters_ as structure of arrays
    Float largestGain_ = 0;      ///< maximum over leaves; 0: nothing is guided
};

}  // namespace ext
