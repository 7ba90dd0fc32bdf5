#pragma once
#include "ext/octree/octree_params.h"
#include "ext/prepass/path_record_store.h"
#include "ext/visibility/visibility_records.h"
#include "pbrt/core/online_model.h"

namespace ext {

/// A shadow ray of the render.
struct RenderShadowRay {
    Point3 p{};
    uint32_t inMedium = 0;  ///< 1 inside a medium, 0 on surfaces
    ShadowRay ray;          ///< of weight 0: an empty place

    bool IsEmpty() const { return !(ray.weight > 0); }
    static RenderShadowRay Read(StateReader &in);
};

/// The learned factors a(leaf, l) of the visibility octree: one VisibilityTree on surfaces and one inside media, built
/// from shadow rays of the prepass. Where lights are chosen through a light tree, both are built again from all shadow
/// rays of prepass and render, after 1, 4, 16 and 64 samples per pixel.
class VisibilityModel final : public OnlineModel, public PathObserver {
  public:
    VisibilityModel(const LightGroups &groups, const OctreeParams &params, Float floor)
        : groups_(groups), params_(params), floor_(floor) {}
    /// The tree over the groups that rows are cuts through; null: rows name all groups. Must outlive its use here.
    void SetLightTree(const LightTree *lights) { lights_ = lights; }

    /// Traces shadow rays from `vertices` and builds both trees, in two phases of the context's progress. Ends early if
    /// it is cancelled.
    void Learn(PrepareContext &context, std::span<PrepassVertex> vertices, const GroupImportance &importance,
               const MeshInterior &interior);
    /// The tree for a vertex; null if nothing was learned there.
    const VisibilityTree *TreeAt(const LightQuery &query) const {
        const Estimate &estimate = EstimateAt(query);
        return estimate.tree.RowCount() > 0 ? &estimate.tree : nullptr;
    }
    /// Shadow rays from a vertex of the prepass.
    size_t RaysPerVertex() const { return RaysPerRecord(groups_.Size(), params_.tries); }
    /// True if the trees are built again during the render.
    bool IsUpdated() const { return lights_ && params_.learn; }

    int NextUpdate() const override { return nextUpdate_; }
    void Update(const Progress &progress) override;
    void ExtractRecords(StateWriter &out) override { rendered_.Extract(out); }
    void MergeRecords(StateReader &in) override { rendered_.Merge(in); }
    PathPlaces BeginPath(Point2i pixel, int sample) const override {
        return rendered_.PlacesOf(paths_.NumberOf(pixel, sample));
    }
    void RecordLightSample(PathPlaces &path, const LightQuery &query, const SampledLight &light,
                           const SampledSpectrum &irradiance) override;

    /// `goesOn`: with all that later updates need.
    void Save(StateWriter &out, bool goesOn) const;
    /// Throws UserError if what was saved does not fit the lights or the context.
    void Load(const PrepareContext &context, StateReader &in);

    void Report(nlohmann::ordered_json &report) const;
    /// The leaf of a vertex, and its factors if there is no light tree.
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const;
    /// Leaves and rows as lines of text; empty if nothing was learned.
    std::string Describe() const;
    size_t Bytes() const { return onSurfaces_.tree.Bytes() + inMedia_.tree.Bytes(); }

  private:
    /// Of one kind of place.
    struct Estimate {
        VisibilityRecords records;       ///< all so far; emptied when no update follows
        VisibilityTree tree;             ///< without rows: nothing was learned
        std::vector<LeafSize> leaves{};  ///< these three for Inspect, Describe and Report only
        std::vector<uint32_t> recordsPerNode{};
        size_t leavesBefore = 0;

        template <class Archive>
        void Visit(Archive &archive) {
            archive(tree, leaves, recordsPerNode, leavesBefore, records);
        }
        /// Empty, or why it does not fit so many groups of lights and the tree over them (or null).
        std::optional<std::string> ValidateFor(size_t groups, const LightTree *lights) const;
    };
    /// The render that the records are of.
    struct Render {
        Bounds2i pixels{};
        int samplesPerPixel = 0, depth = 0;
        bool operator==(const Render &o) const {
            return pixels.low == o.pixels.low && pixels.high == o.pixels.high && samplesPerPixel == o.samplesPerPixel &&
                   depth == o.depth;
        }
    };
    /// Numbers for Report.
    struct Counts {
        size_t prepassRecords = 0, prepassRays = 0, renderRays = 0;
        double buildSeconds = 0, updateSeconds = 0;
    };
    Render RenderOf(const PrepareContext &context) const;
    const Estimate &EstimateAt(const LightQuery &query) const {
        return query.ns == Normal3(0) ? inMedia_ : onSurfaces_;
    }
    /// Builds both trees anew, with `records` per leaf. False: cancelled through `progress`; they are unchanged.
    bool Build(int records, const Progress &progress);
    std::optional<Estimate> Built(const VisibilityRecords &from, int records, const Progress &progress) const;
    size_t RayCount() const { return onSurfaces_.records.rays.size() + inMedia_.records.rays.size(); }
    /// Makes places for the samples after the first `first`, until the next update; if none is due, frees what only
    /// updates need.
    void BeginRecording(int first);
    /// Appends what the render recorded on surfaces or inside media.
    void AppendRendered(VisibilityRecords *records, bool inMedium) const;
    /// Empty, or what is wrong with the schedule that was read. Makes places for the render's records.
    std::optional<std::string> ResumeRecording(const PrepareContext &context);

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
