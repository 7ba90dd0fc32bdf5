#pragma once
#include <memory>
#include <vector>

#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/core/params.h"
#include "pbrt/integrators/guide_grid.h"
#include "pbrt/lightsamplers/light_learner.h"

namespace pbrt {

/// Parameters of guided paths.
struct GuideParams {
    Float share = 0.7f;
    int records = 1 << 20;
    template <class V>
    void Describe(V &&v) {
        v("guide.share", share, Range<Float>{0, 0.95f},
          "largest share of bounces whose direction comes from what was learned, not from the BSDF");
        v("guide.records", records, Range<int>{1000, 1 << 26},
          "at most so many bounces are remembered from one learning to the next (56 bytes each)");
    }
};

/// What a bounce of a path found, to be learned from.
struct GuideRecord {
    Point3 p{};
    Vector3 normal{};            ///< see GuideDirections::Prepare
    Vector3 wi{};                ///< where the path went
    Float radiance = 0;          ///< that the bounce found there, times its MIS weight, averaged over wavelengths
    Float added = 0;             ///< what the bounce added to the path's sample, averaged over wavelengths
    Float pdf = 0;               ///< the density that the path went there with (solid angle); 0: an empty place
    Float bsdfPdf = 0;           ///< the density of the BSDF's own choice
    bool bothSides = false;      ///< see GuideDirections::Prepare
    bool isGlossy = false;       ///< the BSDF has a glossy lobe
    bool isOfFirstHalf = false;  ///< one of the halves of the paths, each of which judges what the other one taught
    bool unused = false;         ///< no padding, so that saved records have the same bytes
};

/// Learns, while a render goes on, from which directions light arrives at a place that only bounces find: light times
/// the bounce's MIS weight, so that what light sampling finds better does not count. A tree of cells over the scene
/// holds a grid of directions each, and for diffuse and for glossy BSDFs the share of bounces that should follow it:
/// the share that makes the second moment of the bounces' contributions least, as one half of the records tells of what
/// the other half taught; 0 where little is gained. It learns together with the light sampler, if that learns
/// (LightLearner).
class PathGuide final : public LightLearner {
  public:
    /// `lights`: the learner of the light sampler, or null.
    PathGuide(const GuideParams &params, LightLearner *lights) : params_(params), lights_(lights) {}
    /// After the light sampler's. `maxDepth`: of the integrator.
    void Prepare(PrepareContext &prepare, int maxDepth);

    /// True if bounces at such a BSDF are guided or learned from.
    static bool Guides(const Bsdf &bsdf);
    /// The grid of the cell that p lies in, and the share of bounces that follow it; null: none do.
    const GuideGrid *At(const Point3 &p, bool isGlossy, Float *share) const;

    /// The places for records of a path. The path keeps the range.
    PathPlaces BeginRecords(Point2i pixel, int sample) const;
    void Record(PathPlaces &path, const GuideRecord &record) {
        if (path.next >= path.end) return;
        GuideRecord &place = places_[path.next++];
        place = record;
        place.isOfFirstHalf = path.end / vertices_ % 2 == 0;
    }

    int NextLearning() const override;
    PathPlaces BeginPath(Point2i pixel, int sample) const override {
        return lights_ ? lights_->BeginPath(pixel, sample) : PathPlaces{};
    }
    void Found(PathPlaces &path, const LightQuery &query, const SampledLight &light,
               const SampledSpectrum &found) override {
        if (lights_) lights_->Found(path, query, light, found);
    }
    void Looked(const LightQuery &query, const Vector3 &d, bool left) override {
        if (lights_) lights_->Looked(query, d, left);
    }
    void TakeFound(StateWriter &out) override;
    void AddFound(StateReader &in) override;
    void Learn(const Progress &progress) override;

    /// What was learned and found, for a checkpoint, without what the light sampler learned.
    void Save(StateWriter &out) const;
    /// Cells, and how many of them guide.
    void Report(nlohmann::ordered_json &json) const;

  private:
    struct Node {
        Float split = 0;
        uint32_t axis = 3;   ///< 3: a leaf
        uint32_t below = 0;  ///< the first of two children in a row; of a leaf: its number
    };
    struct Leaf {
        Float share[2] = {};  ///< for BSDFs without and with glossy lobes
        uint32_t grid = 0;
    };
    struct Tree {
        std::vector<Node> nodes;
        std::vector<Leaf> leaves;
        std::vector<GuideGrid> grids;
    };
    friend class GuideBuilder;

    /// Samples per pixel after which to learn, if it was learned or begun after `first`; 0: not again.
    int NextAfter(int first) const;
    /// Makes places for what samples [first, next) find; for none if `next` is 0.
    void BeginLearning(int first, int next);
    void TakeRecords(StateWriter &out) const;
    void AddRecords(StateReader &in);

    GuideParams params_;
    LightLearner *lights_;
    Tree tree_;
    Bounds2i pixels_{};
    int samplesPerPixel_ = 1, next_ = 0, first_ = 0, stride_ = 1;
    size_t vertices_ = 1, placesPerRow_ = 0;
    std::vector<GuideRecord> places_;
};

}  // namespace pbrt
