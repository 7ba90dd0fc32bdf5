#pragma once
#include "ext/octree/sky_cells.h"
#include "ext/octree/sky_parts.h"
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
class SkyChoice final : public SkyParts {
  public:
    /// Cuts the first kMaxSkies of the skies that are not black.
    SkyChoice(const LightTable &lights, const SkyCells::Settings &settings);

    size_t Count() const override { return skies_.size(); }
    LightId Sky(size_t k) const override { return skies_[k].Sky(); }
    std::vector<LightId> PartsOf(size_t k) const override;

    const Weights *Weigh(const LightQuery &query, LightMemory &memory) const override;
    /// By hierarchical sample warping (Clarberg et al. 2005, Wavelet importance sampling, section 4.2).
    std::optional<SampledLight> Sample(const Weights &weights, size_t k, Point2 *u) const override;
    Float PMF(const Weights &weights, size_t k, LightId light) const override;
    LightId PartTowards(const Weights &weights, size_t k, const Point3 &p, const Vector3 &d) const override;

    /// Whether side^2 shadow rays from some of the vertices to each sky, drawn by G, show that certainly more than the
    /// share `most` of such rays leaves the scene.
    bool SeesMoreThan(double most, const PrepareContext &context, std::span<const PrepassVertex> vertices, int side);
    /// Traces such rays from `count` of the vertices (at most all), spread over the picture.
    std::vector<SkyLook> Look(PrepareContext &context, std::span<const PrepassVertex> vertices, int side, size_t count);
    /// Traces such rays from every vertex, and learns for the first time.
    void LookAround(PrepareContext &context, std::span<const PrepassVertex> vertices, int side);
    /// The share of rays that left the scene, by the last of the functions above. One over it bounds what choosing
    /// tiles can gain.
    double SeenShare() const { return seenShare_; }
    void Count(const Point3 &p, const Vector3 &d, bool left) const;
    /// `judges`: goes back to whole skies for good if next to no ray left the scene until now.
    void Learn(bool judges);
    void Save(StateWriter &writer, bool goesOn) const override;
    void Load(StateReader &reader) override;
    /// False if it was saved without what only learning needs.
    bool CanLearn() const;
    /// See LightLearner.
    void TakeFound(StateWriter &out) { cells_.TakeFound(out); }
    void AddFound(StateReader &in) { cells_.AddFound(in); }
    /// Frees what only learning needs.
    void EndLearning() { cells_.EndLearning(); }

    void Report(nlohmann::ordered_json &report) const override;
    void Inspect(const Point3 &p, std::vector<InspectedValue> &values) const override;
    std::string Describe() const override;
    size_t Bytes() const override;

  private:
    struct AtVertex : Weights {
        const SkyCells::Row *row = nullptr;  ///< null: nothing was learned
        bool isOpen = false;
        Float perSum[kMaxSkies];
        /// The weights of the tiles in the row's packets, and the sums over packets.
        const Float *tiles = nullptr, *packets = nullptr;
    };
    /// Appends the rays from vertex i.
    void LookFrom(const PrepareContext &context, std::span<const PrepassVertex> vertices, int64_t i, int side,
                  std::vector<SkyLook> *looks) const;
    /// Nothing is known yet: all tiles are equally visible, so they are drawn by G.
    void ForgetAll(const PrepareContext &context) { cells_ = MakeCells(context.scene.Bounds(), 0.5f); }
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
