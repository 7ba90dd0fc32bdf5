#pragma once
#include <span>
#include <vector>

#include "ext/guiding/point_tree.h"
#include "ext/guiding/source_clusters.h"

namespace ext {

/// The record of one scattering event.
struct GuideRecord {
    Point3 p{};
    Point3 target{};             ///< where its radiance comes from, through mirrors as well
    Vector3 normal{};            ///< see GuideDirections::Prepare
    Vector3 wi{};                ///< sampled direction
    Float radiance = 0;          ///< from wi, times its MIS weight; mean over wavelengths
    Float contribution = 0;      ///< to the sample, over the throughput `beta`; mean over wavelengths
    Float pdf = 0;               ///< density of wi (solid angle); 0: an empty place
    Float bsdfPdf = 0;           ///< density of BSDF sampling alone
    Float beta = 0;              ///< throughput at p, mean over wavelengths
    bool bothSides = false;      ///< see GuideDirections::Prepare
    bool isGlossy = false;       ///< the BSDF has a glossy lobe
    bool isOfFirstHalf = false;  ///< cross-validation: each half of the paths tests the estimate of the other
    bool unused = false;         ///< no padding, so that saved records have the same bytes

    bool IsEmpty() const { return !(pdf > 0); }
    /// Throws UserError if what is read is no record.
    static GuideRecord Read(StateReader &in);
};

/// The source clusters of a scene and, in a tree of cells over positions, their radiance from each cell and the guiding
/// probability: the one that minimises the second moment of the contributions, by cross-validation of two halves of the
/// records; 0 where nothing is gained.
class GuideCells {
  public:
    /// Estimates everything anew.
    void Learn(std::span<const GuideRecord> records, Float largestProbability);

    /// Radiance of the clusters from the cell of p, and the guiding probability; null: 0. `importance`: squared product
    /// of throughput and PathRoulette::PixelImportance, in units of path cost: the cost that a unit of variance is
    /// worth (EARS). Directions are guided only if that saves more than it costs.
    const PerSourceCluster *At(const Point3 &p, bool isGlossy, Float importance, Float *probability) const {
        if (!MayGuide(importance)) return nullptr;
        const Leaf &leaf = leaves_[tree_.LeafOf(p)];
        const size_t kind = isGlossy ? 1 : 0;
        *probability = leaf.probability[kind];
        return importance * leaf.gain[kind] > kGuidedCost ? &leaf.radiances : nullptr;
    }
    /// All clusters, for GuideDirections.
    const SourceClusters &Clusters() const { return sideBySide_; }
    /// The path cost, in vertices, that guiding saves at p, less its own; 0 where At returns null.
    Float SavedAt(const Point3 &p, bool isGlossy, Float importance) const {
        if (!MayGuide(importance)) return 0;
        return std::max(Float(0), importance * leaves_[tree_.LeafOf(p)].gain[isGlossy ? 1 : 0] - kGuidedCost);
    }
    /// False if directions are guided nowhere.
    bool Guide() const { return largestGain_ > 0; }
    /// False if At returns null everywhere.
    bool MayGuide(Float importance) const { return importance * largestGain_ > kGuidedCost; }
    /// Radiance of the brightest cluster that contains p, over the largest of all; 0: none contains it.
    Float ShinesAt(const Point3 &p) const;
    void Clear() { *this = {}; }
    void Save(StateWriter &out) const;
    void Load(StateReader &in);
    /// Empty, or what is wrong with cells that were read, but for the tree.
    std::optional<std::string> Validate() const;

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
        // For BSDFs without and with glossy lobes.
        Float probability[2] = {};     ///< guiding probability
        Float gain[2] = {};            ///< second moment of the contribution without guiding less that with it
        PerSourceCluster radiances{};  ///< of the clusters; only ratios matter

        bool Guides() const { return gain[0] > 0 || gain[1] > 0; }
    };
    /// Updates what depends on the leaves.
    void LeavesChanged();
    friend class GuideCellsBuilder;

    PointTree tree_;
    std::vector<Leaf> leaves_;
    std::vector<SourceCluster> clusters_;
    SourceClusters sideBySide_;  ///< clusters_, for GuideDirections
    Float largestGain_ = 0;      ///< of all leaves; 0: nothing is guided
};

}  // namespace ext
