#pragma once
#include "ext/octree/octree_params.h"
#include "ext/prepass/path_record_store.h"
#include "ext/visibility/visibility_records.h"
#include "pbrt/core/online_model.h"

namespace ext {

/// Shadow ray recorded during the render.
struct RenderShadowRay {
    Point3 p{};
    uint32_t inMedium = 0;  ///< 1 in media, 0 on surfaces
    ShadowRay ray;          ///< weight 0: empty slot

    bool IsEmpty() const { return !(ray.weight > 0); }
    std::optional<std::string> Validate() const {
        return !IsEmpty() && inMedium <= 1 ? std::nullopt : std::optional("a record has no weight");
    }
};

/// Learned factors a(leaf, l) of the visibility octree: one VisibilityTree for surfaces and one for media, built from
/// prepass shadow rays. With a light tree, both are rebuilt from all shadow rays of prepass and render, after 1, 4, 16
/// and 64 samples per pixel.
class VisibilityModel final : public OnlineModel, public PathObserver {
  public:
    VisibilityModel(const LightGroups &groups, const OctreeParams &params, Float floor)
        : groups_(groups), params_(params), floor_(floor) {}
    /// Light tree whose cuts the rows are; null: rows hold all groups. Not owned.
    void SetLightTree(const LightTree *lights) { lights_ = lights; }

    /// Traces shadow rays from `vertices` and builds both trees, in two progress phases. Returns early if cancelled.
    void Learn(PrepareContext &context, std::span<PrepassVertex> vertices, const GroupImportance &importance,
               const MeshInterior &interior);
    /// Tree for the vertex's domain; null if nothing was learned.
    const VisibilityTree *TreeAt(const LightQuery &query) const {
        const Estimate &estimate = EstimateAt(query);
        return estimate.tree.RowCount() > 0 ? &estimate.tree : nullptr;
    }
    /// Shadow rays per prepass vertex.
    size_t RaysPerVertex() const { return RaysPerRecord(groups_.Size(), params_.tries); }
    double BuildSeconds() const { return counts_.buildSeconds; }  ///< of Learn, without shadow rays
    bool IsUpdated() const { return lights_ && params_.learn; }   ///< true if the trees are rebuilt during the render

    int NextUpdate() const override { return nextUpdate_; }
    void Update(const Progress &progress) override;
    void ExtractRecords(StateWriter &out) override { rendered_.Extract(out); }
    void MergeRecords(StateReader &in) override { rendered_.Merge(in); }
    PathPlaces BeginPath(Point2i pixel, int sample) const override {
        return rendered_.PlacesOf(paths_.NumberOf(pixel, sample));
    }
    void RecordLightSample(PathPlaces &path, const LightQuery &query, const SampledLight &light,
                           const SampledSpectrum &irradiance) override;

    /// `withLearning`: include the state that later updates need.
    void Save(StateWriter &out, bool withLearning) const;
    /// Throws UserError if the saved model does not match the lights or the context.
    void Load(const PrepareContext &context, StateReader &in);

    void Report(nlohmann::ordered_json &report) const;
    /// Leaf of the vertex, and its factors if there is no light tree.
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const;
    std::string Describe() const;  ///< leaves and rows as text; empty if nothing was learned
    size_t Bytes() const { return onSurfaces_.tree.Bytes() + inMedia_.tree.Bytes(); }

  private:
    /// Model for surfaces or for media. Visit leaves out the records, which are saved only for later updates.
    struct Estimate {
        VisibilityRecords records;       ///< all so far; freed when no update follows
        VisibilityTree tree;             ///< without rows: not learned
        std::vector<LeafSize> leaves{};  ///< this and the next two: for Inspect, Describe and Report only
        std::vector<uint32_t> recordsPerNode{};
        size_t leavesBefore = 0;

        void Visit(auto &archive) { archive(tree, leaves, recordsPerNode, leavesBefore); }
        /// Empty if valid for this many light groups and this light tree (or null), else the error.
        std::optional<std::string> ValidateFor(size_t groups, const LightTree *lights) const;
    };
    struct Render {
        Bounds2i pixels{};
        int samplesPerPixel = 0, depth = 0;
        bool operator==(const Render &) const = default;
    };
    struct Counts {
        size_t prepassRecords = 0, prepassRays = 0, renderRays = 0;
        double buildSeconds = 0, updateSeconds = 0;
    };
    Render RenderOf(const PrepareContext &context) const;
    const Estimate &EstimateAt(const LightQuery &query) const {
        return query.ns == Normal3(0) ? inMedia_ : onSurfaces_;
    }
    /// Rebuilds both trees with `records` per leaf. Returns false, leaving them unchanged, if `progress` was cancelled.
    bool Build(int records, const Progress &progress);
    std::optional<Estimate> Built(const VisibilityRecords &from, int records, const Progress &progress) const;
    size_t RayCount() const { return onSurfaces_.records.rays.size() + inMedia_.records.rays.size(); }
    /// Allocates record slots for samples from `first` to the next update; frees update state if none is due.
    void BeginRecording(int first);
    void AppendRendered(VisibilityRecords *records, bool inMedium) const;

    const LightGroups &groups_;
    const LightTree *lights_ = nullptr;
    const OctreeParams &params_;
    Float floor_;
    Estimate onSurfaces_, inMedia_;
    Bounds3 bounds_{};
    Render render_;
    int nextUpdate_ = 0;
    RecordedPaths paths_;
    PathRecordStore<RenderShadowRay> rendered_;
    Counts counts_;
};

}  // namespace ext
