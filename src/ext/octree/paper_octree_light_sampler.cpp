#include "ext/octree/paper_octree_light_sampler.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "ext/prepass/prepass.h"
#include "pbrt/core/effective_params_text.h"
#include "pbrt/core/log.h"
#include "pbrt/lightsamplers/bvh_light_sampler.h"
#include "pbrt/lightsamplers/exhaustive_light_sampler.h"

namespace ext {
namespace {
/// Above this many groups, the floor uses the light BVH instead of exhaustive evaluation.
constexpr size_t kMaxScan = 64;
}  // namespace

PaperOctreeLightSampler::PaperOctreeLightSampler(const LightTable &lights, const OctreeParams &params)
    : GroupLightSampler(params.meshlights ? lights.ByLight() : lights.ByComponent()), params_(params),
      floor_(params.floor > 0 ? params.floor : kPaperFloor) {
    if (groups_.Size() <= kMaxScan) unoccluded_ = std::make_unique<ExhaustiveLightSampler>(groups_);
    else unoccluded_ = std::make_unique<BVHLightSampler>(groups_);
}

void PaperOctreeLightSampler::Prepare(PrepareContext &context) {
    if (context.learned) return LoadLearned(*context.learned);
    if (groups_.Size() <= 1) return;
    auto start = std::chrono::steady_clock::now();
    std::vector<PrepassVertex> vertices = TracePrepassPaths(context, std::max(1, params_.prepassspp), params_.depth);
    vertices_ = vertices.size();
    prepassSeconds_ = SecondsSince(start);
    if (context.progress.Cancelled()) return;

    if (double rays = double(vertices.size()) * double(groups_.Size()); rays > 3e8)
        LogWarning("octree: visibility of {} lights takes {:.1e} shadow rays before the first sample.", groups_.Size(),
                   rays);

    start = std::chrono::steady_clock::now();
    std::vector<Point3> points(vertices.size());
    for (size_t i = 0; i < vertices.size(); ++i) points[i] = vertices[i].at.p;
    context.progress.BeginPhase("octree", int64_t(vertices.size()));
    LightOctreeBuilder builder(context.scene.Bounds(), std::move(points), params_.leaves);
    const size_t groupCount = groups_.Size();
    const LightTable &lights = groups_.Lights();
    tree_ = builder.Build(groupCount, [&](uint32_t index, std::span<double> sum) {
        if (context.progress.Cancelled()) return;
        Rng rng(Hash(uint64_t(0x6f6374726565), context.seed, index));
        for (uint32_t g = 0; g < groupCount; ++g) {
            LightId light = groups_.SampleLight(g, rng.Uniform());
            Point2 u = rng.Uniform2();
            if (Float share = groups_.ShareOf(light); share > 0)
                sum[g] += VisibleContribution(context.scene, vertices[index], lights[light], u) / double(share);
        }
        if (index % 64 == 0) context.progress.Advance(64);
    });
    recordsPerNode_ = builder.PointsPerNode();
    learned_ = true;
    buildSeconds_ = SecondsSince(start);
    context.progress.EndPhase();
}

const void *PaperOctreeLightSampler::WeighGroups(const LightQuery &query, LightMemory &memory) const {
    auto *weights = memory.Make<Weights>();
    if (learned_) weights->cdf = tree_.Cdf(tree_.Row(query.p)).data();
    weights->unoccluded = unoccluded_->WeighGroups(query, memory);
    return weights;
}

std::optional<GroupLightSampler::ChosenGroup> PaperOctreeLightSampler::ChooseGroup(const LightQuery &query,
                                                                                   const void *weights, Float u) const {
    const auto &[cdf, unoccluded] = *static_cast<const Weights *>(weights);
    const Float floor = cdf ? floor_ : 1;
    ChosenGroup chosen;
    if (u < floor) {
        std::optional<ChosenGroup> g =
            unoccluded_->ChooseGroup(query, unoccluded, std::min(u / floor, OneMinusEpsilon));
        if (!g) return {};
        chosen = {g->group, g->pmf, LightGroups::InnerNumber(u, query.p)};
    } else {
        chosen = SampleCdf({cdf, groups_.Size()}, query, std::min((u - floor) / (1 - floor), OneMinusEpsilon));
    }
    if (cdf) chosen.pmf = GroupProbability(query, weights, chosen.group);
    return chosen;
}

Float PaperOctreeLightSampler::GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const {
    const auto &[cdf, unoccluded] = *static_cast<const Weights *>(weights);
    const Float importance = unoccluded_->GroupProbability(query, unoccluded, group);
    return cdf ? (1 - floor_) * CdfPMF({cdf, groups_.Size()}, group) + floor_ * importance : importance;
}

void PaperOctreeLightSampler::Report(nlohmann::ordered_json &report) const {
    report["parameters"] = EffectiveParamsText(params_);
    GroupLightSampler::Report(report);
    report["prepassVertices"] = vertices_;
    report["prepassSeconds"] = prepassSeconds_;
    report["octreeBuildSeconds"] = buildSeconds_;
    report["leaves"] = tree_.LeafCount();
    report["depth"] = tree_.Depth();
    report["bytes"] = tree_.Bytes();
}

void PaperOctreeLightSampler::SaveLearned(StateWriter &writer, bool) const {
    writer(kSavedVersion, learned_, vertices_, prepassSeconds_, buildSeconds_, tree_, recordsPerNode_);
}

void PaperOctreeLightSampler::LoadLearned(StateReader &reader) {
    reader.Require(reader.Value<uint32_t>() == kSavedVersion, kOtherVersion);
    reader(learned_, vertices_, prepassSeconds_, buildSeconds_, tree_, recordsPerNode_);
    reader.Require(!learned_ || tree_.GroupCount() == groups_.Size(), "it has another number of lights");
    reader.Require(!learned_ || (tree_.RowCount() > 0 && recordsPerNode_.size() == tree_.Cells().NodeCount()),
                   "counts of records do not fit the octree");
}

void PaperOctreeLightSampler::Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const {
    CellOctree::Cell cell;
    double records = 0;
    if (learned_) {
        cell = tree_.Cells().CellAt(query.p);
        records = recordsPerNode_[cell.node];
    }
    values.push_back({"leaf", double(cell.node), true});
    values.push_back({"leaf records", records, false});
    values.push_back({"leaf depth", double(cell.depth), false});
}

std::string PaperOctreeLightSampler::DescribeStructure() const {
    if (!learned_)
        return fmt::format("octree: none, there is nothing to choose ({})\n", CountText(groups_.Size(), "light"));
    std::vector<LeafSize> leaves;
    tree_.Cells().ForEachLeaf([&](uint32_t node, uint32_t, int depth) {
        leaves.push_back({depth, recordsPerNode_[node]});
    });
    return fmt::format("octree: {}, {} over {}, {}\nbytes: {} (and {} for this view)\n",
                       CountText(leaves.size(), "leaf", "leaves"), CountText(tree_.RowCount(), "distribution"),
                       CountText(groups_.Size(), "light"), CountText(vertices_, "record"), tree_.Bytes(),
                       recordsPerNode_.capacity() * sizeof(uint32_t)) +
           DescribeLeaves(leaves);
}

}  // namespace ext
