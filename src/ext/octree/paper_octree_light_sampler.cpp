#include "ext/octree/paper_octree_light_sampler.h"

#include <algorithm>

#include "ext/octree/light_octree_builder.h"
#include "ext/prepass/prepass.h"
#include "pbrt/core/log.h"
#include "pbrt/lightsamplers/bvh_light_sampler.h"
#include "pbrt/lightsamplers/exhaustive_light_sampler.h"

namespace ext {

namespace {
/// Above this many groups the floor comes from the light BVH instead of a scan.
constexpr size_t kLargestScan = 64;

double SecondsSince(std::chrono::steady_clock::time_point t) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
}
}  // namespace

PaperOctreeLightSampler::PaperOctreeLightSampler(const LightTable &lights, const OctreeParams &params)
    : params_(params), floor_(params.floor > 0 ? params.floor : kPaperFloor), groups_(lights, params.meshlights) {
    if (groups_.Size() <= kLargestScan) unoccluded_ = std::make_unique<ExhaustiveLightSampler>(groups_.Candidates());
    else unoccluded_ = std::make_unique<BVHLightSampler>(groups_.Candidates());
}

PaperOctreeLightSampler::~PaperOctreeLightSampler() = default;

void PaperOctreeLightSampler::Prepare(PrepareContext &context) {
    if (groups_.Size() <= 1) return;
    auto start = std::chrono::steady_clock::now();
    std::vector<PrepassVertex> vertices = TracePrepassPaths(context, std::max(1, params_.prepassspp), params_.depth);
    vertices_ = vertices.size();
    prepassSeconds_ = SecondsSince(start);
    if (context.progress.Cancelled()) return;

    if (double rays = static_cast<double>(vertices.size()) * static_cast<double>(groups_.Size()); rays > 3e8)
        LogWarning(fmt::format("octree: {} lights to choose from mean {:.1e} shadow rays before the first sample.", groups_.Size(), rays));

    start = std::chrono::steady_clock::now();
    std::vector<Point3> points(vertices.size());
    for (size_t i = 0; i < vertices.size(); ++i) points[i] = vertices[i].at.p;
    context.progress.BeginPhase("octree", static_cast<int64_t>(vertices.size()));
    LightOctreeBuilder builder(context.scene.Bounds(), std::move(points), params_.leaves);
    const size_t groupCount = groups_.Size();
    tree_ = builder.Build(groupCount, [&](uint32_t index, std::span<double> sum) {
        if (context.progress.Cancelled()) return;
        Rng rng(Hash(uint64_t(0x6f6374726565), context.seed, index));
        for (uint32_t g = 0; g < groupCount; ++g) {
            Float uLight = rng.Uniform();
            Point2 u = rng.Uniform2();
            LightId light = groups_.SampleLight(g, uLight);
            if (Float share = groups_.ShareOf(light); share > 0)
                sum[g] += static_cast<double>(VisibleMean(VisibleContribution(context.scene, vertices[index], light, u)) / share);
        }
        if (index % 64 == 0) context.progress.Advance(64);
    });
    recordsPerNode_ = builder.PointsPerNode();
    learned_ = true;
    buildSeconds_ = SecondsSince(start);
    context.progress.EndPhase();
}

Float PaperOctreeLightSampler::GroupPMF(const LightQuery &query, std::span<const Float> cdf, uint32_t group) const {
    Float leaf = cdf[group] - (group > 0 ? cdf[group - 1] : 0);
    return (1 - floor_) * leaf + floor_ * unoccluded_->PMF(query, LightId(group));
}

std::optional<SampledLight> PaperOctreeLightSampler::Sample(const LightQuery &query, Float u) const {
    if (groups_.Size() == 0) return {};
    uint32_t group = 0;
    Float pmf = 1, inner = u;
    if (groups_.Size() > 1) {
        inner = MeshGroups::InnerNumber(u, query.p);
        if (!learned_) {
            std::optional<SampledLight> g = unoccluded_->Sample(query, u);
            if (!g) return {};
            group = g->light.value;
            pmf = g->pmf;
        } else {
            std::span<const Float> cdf = tree_.Cdf(tree_.Row(query.p));
            if (u < floor_) {
                std::optional<SampledLight> g = unoccluded_->Sample(query, std::min(u / floor_, OneMinusEpsilon));
                if (!g) return {};
                group = g->light.value;
            } else {
                Float v = std::min((u - floor_) / (1 - floor_), OneMinusEpsilon);
                group = static_cast<uint32_t>(std::upper_bound(cdf.begin(), cdf.end(), v) - cdf.begin());
                const Float begin = group > 0 ? cdf[group - 1] : 0;
                inner = MeshGroups::InnerNumber(v, query.p, begin, cdf[group] - begin);
            }
            pmf = GroupPMF(query, cdf, group);
        }
    }
    LightId light = groups_.SampleLight(group, inner);
    return SampledLight{light, pmf * groups_.ShareOf(light)};
}

Float PaperOctreeLightSampler::PMF(const LightQuery &query, LightId light) const {
    Float share = groups_.ShareOf(light);
    if (groups_.Size() <= 1) return share;
    uint32_t group = groups_.GroupOf(light);
    if (!learned_) return unoccluded_->PMF(query, LightId(group)) * share;
    return GroupPMF(query, tree_.Cdf(tree_.Row(query.p)), group) * share;
}

void PaperOctreeLightSampler::Report(nlohmann::ordered_json &report) const {
    report["parameters"] = EffectiveParams(params_).dump();
    report["groups"] = groups_.Size();
    report["lights"] = groups_.LightCount();
    report["prepassVertices"] = vertices_;
    report["prepassSeconds"] = prepassSeconds_;
    report["octreeBuildSeconds"] = buildSeconds_;
    report["leaves"] = tree_.LeafCount();
    report["depth"] = tree_.Depth();
    report["bytes"] = tree_.Bytes();
}

}  // namespace ext
