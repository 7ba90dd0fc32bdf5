#pragma once
#include <nlohmann/json_fwd.hpp>

#include "ext/octree/sky_cells.h"
#include "ext/prepass/prepass.h"

namespace ext {

/// Chooses the tile of a sky that gets the shadow ray:
///
///   P(t | x) = G_t(x) (sqrt(v_t) + c) / sum
///
/// c, a constant of the cell, is such that the part of the sum that it makes is the floor e if all tiles face x. G:
/// SkyTiles; the tiles that x's cell tells apart and the share v of rays towards them that leave the scene: SkyCells.
/// In a cell that sees nearly all of the sky there is nothing to choose: there the whole sky is sampled, at its own
/// cost.
class SkyChoice {
  public:
    /// Cuts the first kMaxSkies of the skies that are not black.
    static constexpr size_t kMaxSkies = SkyCells::kMaxSkies;
    SkyChoice(const LightTable &lights, const SkyCells::Settings &settings);

    size_t Count() const { return skies_.size(); }
    LightId Sky(size_t k) const { return skies_[k].Sky(); }
    /// All tiles of sky k that may be chosen somewhere.
    std::vector<LightId> TilesOf(size_t k) const;

    /// What is known of the skies at a vertex.
    struct Weights {
        const SkyCells::Row *row = nullptr;  ///< null: nothing was learned
        bool isOpen = false;
        Float g[kMaxSkies], w[kMaxSkies];  ///< of each sky: sums over its tiles, for the choice among skies and lamps
        Float perSum[kMaxSkies];
        /// The weights of the tiles in the row's packets, and the sums over packets.
        const Float *tiles = nullptr, *packets = nullptr;
    };
    void Weigh(const LightQuery &query, LightMemory &memory, Weights *weights) const;
    /// A tile or the whole of sky k, and its probability given the sky. `u`: uniform on the unit square; what is left
    /// of it for the point in the tile is uniform again (hierarchical sample warping, Clarberg et al. 2005, Wavelet
    /// importance sampling, section 4.2).
    std::optional<SampledLight> Sample(const Weights &weights, size_t k, Point2 *u) const;
    /// `light`: a tile or the whole of sky k.
    Float PMF(const Weights &weights, size_t k, LightId light) const;
    LightId PartTowards(const Weights &weights, size_t k, const Vector3 &d) const;

    /// Traces side^2 shadow rays from every vertex to each sky, drawn by G, and learns for the first time. Where the
    /// rays of some of the vertices show that certainly more than the share `most` of all leaves the scene, ends with
    /// these and learns nothing.
    void LookAround(PrepareContext &context, std::span<const PrepassVertex> vertices, int side, double most);
    /// After LookAround: the share of its rays that left the scene. One over it bounds what choosing tiles can gain.
    double SeenShare() const { return seenShare_; }
    void Count(const Point3 &p, const Vector3 &d, bool left) const;
    /// `judges`: goes back to whole skies for good if next to no ray left the scene until now.
    void Learn(bool judges);
    /// `goesOn`: see LightSampler::SaveLearned.
    void Save(StateWriter &writer, bool goesOn) const;
    void Load(StateReader &reader);
    /// See LightLearner.
    void TakeFound(StateWriter &out) { cells_.TakeFound(out); }
    void AddFound(StateReader &in) { cells_.AddFound(in); }
    /// Frees what only learning needs.
    void EndLearning() { cells_.EndLearning(); }

    void Report(nlohmann::ordered_json &report) const;
    /// The cell at the point, and which share of each sky is seen from it.
    void Inspect(const Point3 &p, std::vector<InspectedValue> &values) const;
    /// The number of cells and what they know, as lines of text.
    std::string Describe() const;
    size_t Bytes() const;

  private:
    /// A shadow ray to a sky, and whether it left the scene.
    struct Look {
        Point3 p;
        Vector3 d;
        bool left;
    };
    /// Appends the rays from vertex i.
    void LookFrom(const PrepareContext &context, std::span<const PrepassVertex> vertices, int64_t i, int side,
                  std::vector<Look> *looks) const;
    /// Whether the rays of some vertices say so for certain; sets seenShare_ to their share.
    bool SeesMoreThan(double most, const PrepareContext &context, std::span<const PrepassVertex> vertices, int side);
    /// One cell that sees the share `visible` of all tiles.
    SkyCells MakeCells(const Bounds3 &bounds, float visible);

    const LightTable &lights_;
    SkyCells::Settings settings_;
    std::vector<SkyTiles> skies_;
    std::vector<bool> wholeIsSampled_;  ///< false: SampleLi of the whole sky leaves it to BSDF sampling
    SkyCells cells_;
    double seenShare_ = 0;
};

}  // namespace ext
