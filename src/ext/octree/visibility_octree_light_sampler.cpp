#include "ext/octree/visibility_octree_light_sampler.h"

#include <algorithm>

#include "ext/octree/prepass_effort.h"
#include "ext/octree/visibility_records.h"
#include "pbrt/bxdfs/bsdf.h"

namespace ext {

namespace {

double SecondsSince(std::chrono::steady_clock::time_point t) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
}

}  // namespace

VisibilityOctreeLightSampler::VisibilityOctreeLightSampler(const LightTable &lights, const OctreeParams &params)
    : GroupLightSampler(lights, params.meshlights, params.interior), params_(params),
      floor_(params.floor > 0 ? params.floor : kVisibilityFloor), importance_(lights, groups_) {
    if (groups_.Size() > kMost) allLights_ = std::make_unique<EmitterTree>(GroupImportance::EmittersOf(lights, groups_));
}

VisibilityOctreeLightSampler::~VisibilityOctreeLightSampler() = default;

double VisibilityOctreeLightSampler::PathsPerPixel(const PrepareContext &context) const {
    if (params_.prepassspp > 0) return params_.prepassspp;
    PrepassEffort effort;
    effort.lights = groups_.Size();
    effort.triesPerVertex = TriesPerRecord(groups_.Size(), params_.tries);
    effort.depth = std::min(params_.depth, std::max(1, context.maxDepth));
    effort.pixels = static_cast<double>(std::max<int64_t>(1, context.pixelBounds.Area()));
    effort.samplesPerPixel = context.samplesPerPixel;
    effort.budget = static_cast<double>(params_.budget);
    return effort.PathsPerPixel();
}

void VisibilityOctreeLightSampler::Prepare(PrepareContext &context) {
    if (groups_.Size() <= 1) return;
    auto start = std::chrono::steady_clock::now();
    const int depth = std::min(params_.depth, std::max(1, context.maxDepth));
    std::vector<PrepassVertex> vertices = TracePrepassPaths(context, PathsPerPixel(context), depth);
    if (context.progress.Cancelled()) return;
    VisibilityRecords records = TraceVisibility(context, vertices, groups_, importance_, interior_, allLights_.get(),
                                                {TriesPerRecord(groups_.Size(), params_.tries), floor_});
    records_ = records.records.size();
    tries_ = records.tries.size();
    prepassSeconds_ = SecondsSince(start);
    if (context.progress.Cancelled()) return;

    start = std::chrono::steady_clock::now();
    context.progress.BeginPhase("octree", 0);
    VisibilityBuildSettings settings;
    settings.lightCount = static_cast<int>(groups_.Size());
    settings.largestFullRow = static_cast<int>(kMost);
    settings.records = params_.records;
    settings.shrinkage = params_.shrinkage;
    settings.pruneGain = params_.prunegain;
    settings.secondMoment = params_.secondmoment;
    settings.floor = allLights_ ? params_.treeshare : floor_;
    VisibilityTreeBuilder builder(context.scene.Bounds(), records.records, records.tries, settings);
    leavesBefore_ = builder.LeavesBeforePruning();
    tree_ = builder.Build();
    leaves_ = builder.Leaves();
    recordsPerNode_ = builder.RecordsPerNode();
    learned_ = true;
    buildSeconds_ = SecondsSince(start);
    context.progress.EndPhase();
}

void VisibilityOctreeLightSampler::Weigh(const LightQuery &query, Choice *c) const {
    VisibilityTree::Row row;
    if (learned_) row = tree_.RowAt(query.p);
    if (allLights_) {
        c->lights = row.lights;
        c->count = row.lights.size();
        c->sumG = importance_.EvaluateSome(query, c->lights, c->g);
    } else {
        c->count = groups_.Size();
        c->sumG = importance_.Evaluate(query, c->g);
    }
    const Float *decode = VisibilityTree::Table().data();
    c->sumW = 0;
    for (size_t i = 0; i < c->count; ++i) {
        c->w[i] = learned_ ? c->g[i] * decode[row.codes[i]] : c->g[i];
        c->sumW += c->w[i];
    }
    if (params_.bsdf && query.bsdf && query.bsdf->IsDirectional()) FollowBsdf(query, c);
    // sumW is 0 only where sumG is.
    c->perW = c->sumW > 0 ? (allLights_ ? 1 : 1 - floor_) / c->sumW : 0;
    c->perG = c->sumW > 0 && !allLights_ ? floor_ / c->sumG : 0;
    c->treeShare = !allLights_ ? 0 : c->sumW > 0 ? std::max(params_.treeshare, row.missing) : 1;
}

void VisibilityOctreeLightSampler::FollowBsdf(const LightQuery &query, Choice *c) const {
    // The light's middle may lie beside the lobe while its rim is in it, so a tenth goes to all alike.
    constexpr Float kAlike = 0.1f;
    // What has so small a part in G is not worth a look, whatever the lobe.
    const Float worthLooking = c->sumW * 1e-3f;
    Vector3 wi[kMost];
    uint8_t looked[kMost];
    size_t count = 0;
    for (size_t i = 0; i < c->count; ++i) {
        if (!(c->w[i] > worthLooking)) continue;
        wi[count] = importance_.DirectionTo(query.p, c->lights.empty() ? static_cast<uint32_t>(i) : c->lights[i]);
        if (wi[count] != Vector3(0)) looked[count++] = static_cast<uint8_t>(i);
    }
    Float f[kMost];
    query.bsdf->ApproximateF(query.wo, {wi, count}, f);
    Float weighted = 0, weights = 0;
    for (size_t k = 0; k < count; ++k) {
        weighted += f[k] * c->w[looked[k]];
        weights += c->w[looked[k]];
    }
    const Float mean = weights > 0 ? weighted / weights : 0;
    if (!(mean > 0) || !std::isfinite(mean)) return;
    // Relative to the lights that were not looked at, which keep their weights.
    for (size_t k = 0; k < count; ++k) c->w[looked[k]] *= (f[k] / mean + kAlike) / (1 + kAlike);
    c->sumW = 0;
    for (size_t i = 0; i < c->count; ++i) c->sumW += c->w[i];
}

Float VisibilityOctreeLightSampler::NamedPMF(const Choice &c, uint32_t group) const {
    if (!allLights_) return c.Share(group);
    auto it = std::lower_bound(c.lights.begin(), c.lights.end(), group);
    return it != c.lights.end() && *it == group ? c.Share(static_cast<size_t>(it - c.lights.begin())) : 0;
}

Float VisibilityOctreeLightSampler::MixedPMF(const Choice &c, uint32_t group, Float fromTree) const {
    return (1 - c.treeShare) * NamedPMF(c, group) + c.treeShare * fromTree;
}

Float VisibilityOctreeLightSampler::GroupPMF(const LightQuery &query, const Choice &c, uint32_t group) const {
    return allLights_ ? MixedPMF(c, group, allLights_->PMF(query, group)) : NamedPMF(c, group);
}

std::optional<GroupLightSampler::ChosenGroup> VisibilityOctreeLightSampler::SampleGroup(const LightQuery &query, Float u) const {
    Choice c;
    Weigh(query, &c);
    if (u < c.treeShare) {
        std::optional<SampledLight> chosen = allLights_->Sample(query, std::min(u / c.treeShare, OneMinusEpsilon));
        if (!chosen) return {};
        const uint32_t group = chosen->light.value;
        return ChosenGroup{group, MixedPMF(c, group, chosen->pmf), MeshGroups::InnerNumber(u, query.p)};
    }
    const Float v = std::min((u - c.treeShare) / (1 - c.treeShare), OneMinusEpsilon);
    Float running = 0, last = 0;
    std::optional<size_t> chosen;
    for (size_t i = 0; i < c.count; ++i) {
        Float share = c.Share(i);
        if (!(share > 0)) continue;
        chosen = i;
        last = share;
        running += share;
        if (v < running) break;
    }
    if (!chosen) return {};
    const uint32_t group = c.lights.empty() ? static_cast<uint32_t>(*chosen) : c.lights[*chosen];
    return ChosenGroup{group, GroupPMF(query, c, group), MeshGroups::InnerNumber(v, query.p, running - last, last)};
}

Float VisibilityOctreeLightSampler::GroupPMF(const LightQuery &query, uint32_t group) const {
    Choice c;
    Weigh(query, &c);
    return GroupPMF(query, c, group);
}

void VisibilityOctreeLightSampler::Report(nlohmann::ordered_json &report) const {
    report["parameters"] = EffectiveParams(params_).dump();
    GroupLightSampler::Report(report);
    report["prepassVertices"] = records_;
    report["prepassShadowRays"] = tries_;
    report["prepassSeconds"] = prepassSeconds_;
    report["octreeBuildSeconds"] = buildSeconds_;
    report["leavesBeforePruning"] = leavesBefore_;
    report["leaves"] = tree_.LeafCount();
    report["rows"] = tree_.RowCount();
    report["depth"] = tree_.Depth();
    report["bytes"] = tree_.Bytes() + importance_.Bytes() + interior_.Bytes() + (allLights_ ? allLights_->Bytes() : 0);
}

}  // namespace ext
