#include "ext/octree/learned_visibility_light_sampler.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "ext/octree/prepass_budget.h"
#include "pbrt/core/effective_params_text.h"

namespace ext {
namespace {

/// True if emissive meshes are single lights. If all emissive primitives fit into one packet, evaluating all of them is
/// faster than selecting a mesh and then a primitive.
bool MeshesAreLights(const LightTable &lights, const OctreeParams &params) {
    return params.meshlights && (lights.ByLight().Size() <= 1 || lights.ByComponent().Size() > EmitterPacket::kLanes);
}

}  // namespace

LearnedVisibilityLightSampler::LearnedVisibilityLightSampler(const LightTable &lights, const OctreeParams &params)
    : InteriorLightSampler(lights, MeshesAreLights(lights, params), params.interior), params_(params),
      floor_(params.floor > 0 ? params.floor : kVisibilityFloor), portals_(groups_, params.portals, floor_),
      importance_(groups_), model_(groups_, params_, floor_) {
    PortalsChanged();
}

void LearnedVisibilityLightSampler::PortalsChanged() {
    std::vector<Emitter> emitters = GroupImportance::EmittersOf(groups_);
    for (size_t k = 0; k < portals_.Count(); ++k) emitters[portals_.GroupOf(k)] = {};
    importance_ = GroupImportance(emitters);
    if (groups_.Size() > kMaxCandidates) lightTree_ = std::make_unique<LightTree>(emitters);
    model_.SetLightTree(lightTree_.get());
    SetAlwaysChooses(portals_.IsActive());
}

void LearnedVisibilityLightSampler::Prepare(PrepareContext &context) {
    if (portals_.IsActive()) {  // Prepare was called before.
        portals_.Clear();
        PortalsChanged();
    }
    if (context.learned) return LoadLearned(context, *context.learned);
    if (groups_.Size() <= 1 && !portals_.IsWanted(context)) return;
    const auto start = std::chrono::steady_clock::now();
    const int depth = params_.PrepassDepth(context.maxDepth);
    const PrepassBudget budget{.lights = groups_.Size(),
                               .raysPerVertex = model_.RaysPerVertex(),
                               .environmentRays = portals_.IsWanted(context) ? portals_.RaysPerVertex() : 0,
                               .depth = depth,
                               .pixels = double(std::max<int64_t>(1, context.pixelBounds.Area())),
                               .samplesPerPixel = context.samplesPerPixel,
                               .budget = double(params_.budget)};
    std::vector<PrepassVertex> vertices =
        TracePrepassPaths(context, params_.prepassspp > 0 ? params_.prepassspp : budget.PathsPerPixel(), depth);
    if (portals_.IsWanted(context) && !context.progress.Cancelled()) {
        portals_.Find(context, vertices);
        if (portals_.IsActive()) PortalsChanged();
    }
    Learn(context, vertices);
    if (portals_.IsActive() && portals_.IsOnTrial()) TryPortals(context, vertices);
    prepassSeconds_ = SecondsSince(start) - model_.BuildSeconds();
}

void LearnedVisibilityLightSampler::Learn(PrepareContext &context, std::span<PrepassVertex> vertices) {
    if (context.progress.Cancelled() || groups_.Size() <= std::max<size_t>(portals_.Count(), 1)) return;
    model_.Learn(context, vertices, importance_, interior_);
}

void LearnedVisibilityLightSampler::TryPortals(PrepareContext &context, std::span<PrepassVertex> vertices) {
    const auto use = [&](bool active) {
        portals_.SetActive(active);
        PortalsChanged();
        Learn(context, vertices);
    };
    const std::vector<TrialPixel> with = TraceTrial(context);
    use(false);
    const double cost = portals_.CostPerVertex(context.scene);
    if (portals_.EndTrial(CompareTrials(with, TraceTrial(context), cost))) use(true);
}

void LearnedVisibilityLightSampler::SaveLearned(StateWriter &writer, bool withLearning) const {
    writer(kSavedVersion, withLearning, prepassSeconds_);
    portals_.Save(writer);
    writer(LightTreeHash());
    model_.Save(writer, withLearning);
}

void LearnedVisibilityLightSampler::LoadLearned(const PrepareContext &context, StateReader &reader) {
    reader.Require(reader.Value<uint32_t>() == kSavedVersion, kOtherVersion);
    reader.Require(reader.Value<bool>() == context.learnsOn, "it is of another use");
    reader(prepassSeconds_);
    portals_.Load(reader);
    PortalsChanged();
    reader.Require(reader.Value<uint64_t>() == LightTreeHash(), "it belongs to other lights");
    model_.Load(context, reader);
}

uint64_t LearnedVisibilityLightSampler::LightTreeHash() const {
    uint64_t hash = Hash(uint64_t{groups_.Size()}, uint64_t{lightTree_ ? lightTree_->NodeCount() : 0});
    if (!lightTree_) return hash;
    for (uint32_t n = 0; n < lightTree_->NodeCount(); ++n)
        hash = Hash(hash, lightTree_->At(n).begin, lightTree_->At(n).end);
    for (uint32_t p = 0; p < lightTree_->LightCount(); ++p) hash = Hash(hash, lightTree_->LightAt(p));
    return hash;
}

void LearnedVisibilityLightSampler::Report(nlohmann::ordered_json &report) const {
    report["parameters"] = EffectiveParamsText(params_);
    GroupLightSampler::Report(report);
    report["prepassSeconds"] = prepassSeconds_;
    model_.Report(report);
    portals_.Report(report);
    report["bytes"] = model_.Bytes() + importance_.Bytes() + interior_.Bytes() +
                      (lightTree_ ? lightTree_->Bytes() : 0) + (portals_.IsActive() ? portals_.Bytes() : 0);
}

void LearnedVisibilityLightSampler::Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const {
    model_.Inspect(query, values);
    portals_.Inspect(query.p, values);
}

std::string LearnedVisibilityLightSampler::DescribeStructure() const {
    const std::string text = model_.Describe() + portals_.Describe();
    return text.empty()
               ? fmt::format("octree: none, there is nothing to choose ({})\n", CountText(groups_.Size(), "light"))
               : text;
}

}  // namespace ext
