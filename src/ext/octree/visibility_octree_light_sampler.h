#pragma once
#include <memory>

#include "ext/groups/group_importance.h"
#include "ext/groups/interior_light_sampler.h"
#include "ext/groups/light_tree.h"
#include "ext/octree/octree_params.h"
#include "ext/octree/render_records.h"
#include "ext/octree/structure_text.h"
#include "ext/octree/visibility_tree.h"
#include "ext/octree/window_choice.h"
#include "ext/prepass/prepass.h"
#include "pbrt/core/online_model.h"
#include "pbrt/lightsamplers/path_observer.h"

namespace ext {

/// The octree sampler's own model: geometry at the point, visibility from the tree.
///
///   P(l | x) = (1 - e) G_l(x) a(leaf, l) b_l(x) / sum + e G_l(x) / sum G
///
/// G (GroupImportance) is what would arrive unoccluded, evaluated at the shading point; a is how much of G the prepass
/// found in the point's leaf, the root mean square of found over unoccluded (VisibilityTreeBuilder); b follows the BSDF
/// towards the light's middle where the surface is glossy without a diffuse part, and is 1 elsewhere. Light l is a
/// group; inside a mesh the primitive is chosen by MeshInterior. With more than 64 groups l is a node of a cut through
/// a tree over them (LightTree); every leaf has its own cut, fine where its light comes from, coarse elsewhere, and
/// below a node lights are chosen level by level by G. Such a sampler goes on learning from the render's shadow rays:
/// after 1, 4, 16 and 64 samples a pixel it builds its tree again from everything found until then.
///
/// Inside media the same is done with factors of their own: there a is the root mean square of how much a shadow ray
/// finds through walls and media alike, G has no cosine, and b follows a peaked phase function.
///
/// Skies are divided by the windows that they are seen through (WindowChoice), where there are some: then each sky is
/// one light l whose a G is the sum over its parts.
class VisibilityOctreeLightSampler final : public InteriorLightSampler, private OnlineModel, private PathObserver {
  public:
    VisibilityOctreeLightSampler(const LightTable &lights, const OctreeParams &params);
    ~VisibilityOctreeLightSampler() override;

    void Prepare(PrepareContext &context) override;
    OnlineModel *Model() override { return IsUpdated() ? this : nullptr; }
    PathObserver *Observer() override { return IsUpdated() ? this : nullptr; }
    bool SavesLearned() const override { return true; }
    void SaveLearned(StateWriter &writer, bool goesOn) const override;
    std::vector<LightId> SkyPartsOf(LightId infinite) const override;
    void Report(nlohmann::ordered_json &report) const override;
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override;
    std::string DescribeStructure() const override;

  private:
    /// The tree over the lights is estimated again from shadow rays of the render.
    bool IsUpdated() const { return lightTree_ && params_.learn; }

    static constexpr size_t kMax = 64;
    /// Weights of the lights considered at a point. The divided skies come after `count` others.
    struct Choice {
        alignas(32) Float g[kMax + WindowChoice::kMaxSkies], w[kMax + WindowChoice::kMaxSkies];
        Float lampG = 0;  ///< sum over g without the divided skies
        Float sumG = 0, sumW = 0;
        Float perW = 0, perG = 0;         ///< P = w perW + g perG
        std::span<const uint32_t> nodes;  ///< of the light tree; empty: all lights, in order
        size_t count = 0, all = 0;
        const WindowChoice::Weights *sky = nullptr;
        Float Share(size_t i) const { return w[i] * perW + g[i] * perG; }
        void SumUp() {
            sumW = 0;
            for (size_t i = 0; i < all; ++i) sumW += w[i];
        }
    };
    void FollowScattering(const LightQuery &query, Choice *choice) const;
    const void *WeighGroups(const LightQuery &query, LightMemory &memory) const override;
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const override;
    Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const override;
    std::optional<SampledLight> ChooseInside(const LightQuery &query, const void *weights, uint32_t group, Float u,
                                             Point2 *uPoint) const override;
    Float ProbabilityInside(const LightQuery &query, const void *weights, LightId light) const override;
    LightId PartOf(const LightQuery &query, const void *weights, LightId infinite, const Point3 &p,
                   const Vector3 &d) const override;
    /// The index of the divided sky that the group is; SkyCount() if it is none of them.
    size_t SkyOfGroup(uint32_t group) const;
    size_t SkyCount() const { return skyGroups_.size(); }
    /// Emitters of all groups; those of divided skies are dark.
    std::vector<Emitter> LampEmitters() const;
    std::unique_ptr<WindowChoice> MakeWindows() const;
    /// Divides skies by windows if there are some that pay, and not more of the sky is seen than they are worth.
    void LookForWindows(PrepareContext &context, std::span<const PrepassVertex> vertices);
    /// Divides skies by these windows; null: no more.
    void UseWindows(std::unique_ptr<WindowChoice> windows);
    double PathsPerPixel(const PrepareContext &context) const;
    size_t Tries() const { return TriesPerRecord(groups_.Size(), params_.tries); }
    void LoadLearned(const PrepareContext &context, StateReader &reader);
    /// Empty, or what is wrong with the schedule of learning that was read. Makes places for the render's records.
    std::optional<std::string> TakeUpLearning(const PrepareContext &context);
    /// Frees what only learning needs.
    void EndLearning();
    /// Changes with the numbers of the light tree's nodes and with the lights.
    uint64_t NamesHash() const;
    /// What was found at one kind of place, and the tree made from it.
    struct Knowledge {
        VisibilityRecords known;  ///< all records so far; emptied when no learning is to come
        VisibilityTree tree;
        bool learned = false;            ///< there is a tree
        std::vector<LeafSize> leaves{};  ///< these three for Inspect, DescribeStructure and Report only
        std::vector<uint32_t> recordsPerNode{};
        size_t leavesBefore = 0;
        void Save(StateWriter &writer, bool goesOn) const;
        void Load(StateReader &reader);
        /// Empty, or why it does not fit so many groups of lights and the tree over them (or null).
        std::optional<std::string> Validate(size_t groups, const LightTree *lights) const;
    };
    const Knowledge &KnowledgeAt(const LightQuery &query) const {
        return query.ns == Normal3(0) ? inMedia_ : onSurfaces_;
    }
    /// Builds the trees anew from what is known. False: cancelled through `progress`; they are unchanged.
    bool Build(int records, const Progress &progress);
    std::optional<Knowledge> Built(const Knowledge &from, int records, const Progress &progress) const;
    size_t TryCount() const { return onSurfaces_.known.tries.size() + inMedia_.known.tries.size(); }

    int NextUpdate() const override { return nextLearning_; }
    PathPlaces BeginPath(Point2i pixel, int sample) const override { return found_.BeginPath(pixel, sample); }
    void RecordLightSample(PathPlaces &path, const LightQuery &query, const SampledLight &light,
                           const SampledSpectrum &found) override;
    void Update(const Progress &progress) override;
    void ExtractRecords(StateWriter &out) override { found_.Take(out); }
    void MergeRecords(StateReader &in) override { found_.Add(in); }
    void BeginLearning(int first);

    OctreeParams params_;
    Float floor_;
    std::vector<LightId> skies_;             ///< that windows are looked for
    std::unique_ptr<WindowChoice> windows_;  ///< null: all skies are chosen as a whole
    std::vector<uint32_t> skyGroups_;        ///< of divided skies
    GroupImportance importance_;             ///< dark where a sky is divided
    std::unique_ptr<LightTree> lightTree_;   ///< null: at most kMax groups, all of which are weighed
    Knowledge onSurfaces_, inMedia_;
    size_t prepassRecords_ = 0, prepassTries_ = 0, learnedTries_ = 0;
    double prepassSeconds_ = 0, buildSeconds_ = 0, learningSeconds_ = 0;
    double skySeconds_ = 0, skySeenShare_ = 0;  ///< of the search for windows; share of its rays that left the scene

    RenderRecords found_;
    Bounds3 sceneBounds_;
    Bounds2i pixels_;
    int nextLearning_ = 0, samplesPerPixel_ = 0, depth_ = 0;
};

}  // namespace ext
