#pragma once
#include <span>
#include <vector>

#include "pbrt/integrators/guide_targets.h"
#include "pbrt/integrators/point_tree.h"

namespace pbrt {

/// What a bounce of a path found, to be learned from.
struct GuideRecord {
    Point3 p{};
    Point3 target{};             ///< the place that it reached, or seemed to reach in mirrors
    Vector3 normal{};            ///< see GuideDirections::Prepare
    Vector3 wi{};                ///< where the path went
    Float radiance = 0;          ///< that the bounce found there, times its MIS weight, averaged over wavelengths
    Float found = 0;             ///< what the bounce added to the sample, for a path of weight 1; mean of wavelengths
    Float pdf = 0;               ///< the density that the path went there with (solid angle); 0: an empty place
    Float bsdfPdf = 0;           ///< the density of the BSDF's own choice
    Float beta = 0;              ///< the path's weight where the bounce begins, mean over wavelengths
    bool bothSides = false;      ///< see GuideDirections::Prepare
    bool isGlossy = false;       ///< the BSDF has a glossy lobe
    bool isOfFirstHalf = false;  ///< one of the halves of the paths, each of which judges what the other one taught
    bool unused = false;         ///< no padding, so that saved records have the same bytes

    /// Throws UserError if what is read is no record.
    static GuideRecord Read(StateReader &in);
};

/// Which places in the scene shine, as bounces found them (GuideTarget), and in a tree of cells: which of them the cell
/// sees, how bright, and the share of bounces that should go there. The share is the one that makes the second moment
/// of the bounces' contributions least, as one half of the records tells of what the other half taught; 0 where nothing
/// is gained.
class GuideCells {
  public:
    /// Forgets all and learns from records.
    void Learn(std::span<const GuideRecord> records, Float largestShare);

    /// How bright the Targets are where p lies, and which share of bounces is guided to them; null: none is. `worth`:
    /// the part of its pixel's variance, in vertices that it is worth, that a path has whose found light squared is 1
    /// (PathRoulette::Worth times the path's weight, squared). A bounce is guided only if that saves more than it
    /// costs.
    const PerGuideTarget *At(const Point3 &p, bool isGlossy, Float worth, Float *share) const {
        if (!MayGuide(worth)) return nullptr;
        const Leaf &leaf = leaves_[tree_.LeafOf(p)];
        const size_t kind = isGlossy ? 1 : 0;
        *share = leaf.share[kind];
        return worth * leaf.gain[kind] > kGuidedCost ? &leaf.radiances : nullptr;
    }
    /// The places that shine.
    const GuideTargets &Targets() const { return sideBySide_; }
    /// What a bounce saves, in vertices, by being guided where At gives targets, less what that costs; otherwise 0.
    Float SavedAt(const Point3 &p, bool isGlossy, Float worth) const {
        if (!MayGuide(worth)) return 0;
        return std::max(Float(0), worth * leaves_[tree_.LeafOf(p)].gain[isGlossy ? 1 : 0] - kGuidedCost);
    }
    /// False if nothing is guided anywhere.
    bool Guide() const { return largestGain_ > 0; }
    /// False if At gives null anywhere.
    bool MayGuide(Float worth) const { return worth * largestGain_ > kGuidedCost; }
    /// The radiance of the brightest ball that p lies in, over that of the brightest of all; 0: it lies in none.
    Float ShinesAt(const Point3 &p) const;
    void Forget() { *this = {}; }
    void Save(StateWriter &out) const;
    void Load(StateReader &in);
    /// Empty, or what is wrong with cells that were read, but for the tree.
    std::optional<std::string> Validate() const;

    size_t Cells() const { return leaves_.size(); }
    size_t GuidingCells() const;
    double MeanShare() const;
    size_t Bytes() const {
        return tree_.Bytes() + leaves_.size() * sizeof(Leaf) + targets_.size() * sizeof(GuideTarget);
    }

  private:
    /// What a guided bounce costs besides, in vertices.
    static constexpr Float kGuidedCost = 0.15f;
    struct Leaf {
        // For BSDFs without and with glossy lobes.
        Float share[2] = {};
        Float gain[2] = {};          ///< how much less the second moment of `found` is with the share than without
        PerGuideTarget radiances{};  ///< of the targets; only ratios matter

        bool Guides() const { return gain[0] > 0 || gain[1] > 0; }
    };
    /// Sets what follows from the leaves.
    void LeavesChanged();
    friend class GuideCellsBuilder;

    PointTree tree_;
    std::vector<Leaf> leaves_;
    std::vector<GuideTarget> targets_;
    GuideTargets sideBySide_;  ///< targets_, for GuideDirections
    Float largestGain_ = 0;    ///< of all leaves; 0: none guides
};

}  // namespace pbrt
