#pragma once
#include <span>
#include <vector>

#include "ext/guiding/point_tree.h"
#include "ext/guiding/source_clusters.h"

namespace ext {

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
    template <class Archive>
    void Visit(Archive &archive) {
        archive(p, target, normal, wi, radiance, contribution, pdf, bsdfPdf, beta, bothSides, isGlossy, isOfFirstHalf,
                unused);
    }
    /// Empty if valid, else the error.
    std::optional<std::string> Validate() const;
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
        const Leaf &leaf = leaves_[tree_.LeafOf(p)];
        const size_t kind = isGlossy ? 1 : 0;
        *probability = leaf.probability[kind];
        return importance * leaf.gain[kind] > kGuidedCost ? &leaf.radiances : nullptr;
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
    Float ShinesAt(const Point3 &p) const;
    void Clear() { *this = {}; }
    /// After loading, LeavesChanged completes the members that are not saved.
    template <class Archive>
    void Visit(Archive &archive) {
        archive(leaves_, clusters_, tree_);
    }
    /// Empty if valid, else the error.
    std::optional<std::string> Validate() const;
    void LeavesChanged();

    size_t Cells() const { return leaves_.size(); }
    size_t GuidingCells() const;
    double MeanProbability() const;
    size_t Bytes() const {
        return tree_.Bytes() + leaves_.size() * sizeof(Leaf) + clusters_.size() * sizeof(SourceCluster);
    }

  private:
    /// Additional cost of a guided direction, in vertices.
    static constexpr Float kGuidedCost = 0.15f;
    struct Leaf {
        // Index 0: BSDFs without a glossy lobe; 1: with one.
        Float probability[2] = {};     ///< guiding probability
        Float gain[2] = {};            ///< reduction of the contribution's second moment by guiding
        PerSourceCluster radiances{};  ///< per cluster; only ratios matter

        bool Guides() const { return gain[0] > 0 || gain[1] > 0; }
    };
    friend class GuideCellsBuilder;

    PointTree tree_;
    std::vector<Leaf> leaves_;
    std::vector<SourceCluster> clusters_;
    SourceClusters sideBySide_;  ///< clusters_ as structure of arrays
    Float largestGain_ = 0;      ///< maximum over leaves; 0: nothing is guided
};

}  // namespace ext
