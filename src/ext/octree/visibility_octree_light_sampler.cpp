#include "ext/octree/visibility_octree_light_sampler.h"

#include <algorithm>

#include "ext/octree/visibility_records.h"
#include "pbrt/bxdfs/bsdf.h"

namespace ext {

namespace {

double SecondsSince(std::chrono::steady_clock::time_point t) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
}

/// Surfaces whose BSDF is worth following and cheap to ask: glossy ones without a diffuse part and without layers.
bool IsWorthFollowing(const Bsdf *bsdf) {
    if (!bsdf) return false;
    BxdfFlags flags = bsdf->Flags();
    return Has(flags, BxdfFlags::Glossy) && !Has(flags, BxdfFlags::Diffuse) && !bsdf->IsLayered();
}

}  // namespace

VisibilityOctreeLightSampler::VisibilityOctreeLightSampler(const LightTable &lights, const OctreeParams &params)
    : params_(params), floor_(params.floor > 0 ? params.floor : kVisibilityFloor), groups_(lights, params.meshlights),
      importance_(lights, groups_), interior_(lights, groups_, params.interior) {
    if (groups_.Size() > kMost) allLights_ = std::make_unique<EmitterTree>(GroupImportance::EmittersOf(lights, groups_));
}

VisibilityOctreeLightSampler::~VisibilityOctreeLightSampler() = default;

double VisibilityOctreeLightSampler::PathsPerPixel(const PrepareContext &context) const {
    if (params_.prepassspp > 0) return params_.prepassspp;
    // A render's sample costs about two rays a vertex, a prepass vertex one ray and its tries.
    const auto pixels = static_cast<double>(std::max<int64_t>(1, context.pixelBounds.Area()));
    const double tries = static_cast<double>(TriesPerRecord(groups_.Size(), params_.tries));
    const double depth = std::min(params_.depth, std::max(1, context.maxDepth));
    const double byBudget = static_cast<double>(params_.budget) * context.samplesPerPixel * 2 / (1 + tries);
    constexpr double kFewest = 2000, kMostTries = 4e6;
    return std::clamp(byBudget, kFewest / (pixels * depth), std::max(kMostTries / (pixels * depth * tries), 1e-9));
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
    c->sumW = 0;
    for (size_t i = 0; i < c->count; ++i) {
        c->w[i] = learned_ ? c->g[i] * VisibilityTree::Decode(row.codes[i]) : c->g[i];
        c->sumW += c->w[i];
    }
    if (params_.bsdf && IsWorthFollowing(query.bsdf)) FollowBsdf(query, c);
}

void VisibilityOctreeLightSampler::FollowBsdf(const LightQuery &query, Choice *c) const {
    // The light's middle may lie beside the lobe while its rim is in it, so a tenth goes to all alike.
    constexpr Float kAlike = 0.1f;
    Float f[kMost];
    Float weighted = 0, weights = 0;
    for (size_t i = 0; i < c->count; ++i) {
        f[i] = -1;
        if (!(c->w[i] > 0)) continue;
        Vector3 wi = importance_.DirectionTo(query.p, c->lights.empty() ? static_cast<uint32_t>(i) : c->lights[i]);
        if (wi == Vector3(0)) continue;
        f[i] = query.bsdf->F(query.wo, wi).Average();
        weighted += f[i] * c->w[i];
        weights += c->w[i];
    }
    const Float mean = weights > 0 ? weighted / weights : 0;
    if (!(mean > 0) || !std::isfinite(mean)) return;
    c->sumW = 0;
    for (size_t i = 0; i < c->count; ++i) {
        c->w[i] *= (f[i] < 0 ? mean : f[i]) / mean + kAlike;
        c->sumW += c->w[i];
    }
}

Float VisibilityOctreeLightSampler::Share(const Choice &c, size_t i) const {
    // sumW is 0 only where sumG is.
    if (!(c.sumW > 0)) return 0;
    if (allLights_) return c.w[i] / c.sumW;
    return (1 - floor_) * (c.w[i] / c.sumW) + floor_ * (c.g[i] / c.sumG);
}

Float VisibilityOctreeLightSampler::GroupPMF(const LightQuery &query, const Choice &c, uint32_t group) const {
    if (!allLights_) return Share(c, group);
    const Float fromTree = allLights_->PMF(query, group);
    if (!(c.sumW > 0)) return fromTree;
    auto it = std::lower_bound(c.lights.begin(), c.lights.end(), group);
    Float named = it != c.lights.end() && *it == group ? Share(c, static_cast<size_t>(it - c.lights.begin())) : 0;
    return (1 - params_.treeshare) * named + params_.treeshare * fromTree;
}

std::optional<SampledLight> VisibilityOctreeLightSampler::SampleGroup(const LightQuery &query, Float u) const {
    Choice c;
    Weigh(query, &c);
    if (allLights_) {
        const Float t = c.sumW > 0 ? params_.treeshare : Float(1);
        if (u < t) {
            std::optional<SampledLight> chosen = allLights_->Sample(query, std::min(u / t, OneMinusEpsilon));
            if (chosen) chosen->pmf = GroupPMF(query, c, chosen->light.value);
            return chosen;
        }
        u = std::min((u - t) / (1 - t), OneMinusEpsilon);
    }
    Float running = 0;
    std::optional<size_t> chosen;
    for (size_t i = 0; i < c.count; ++i) {
        Float share = Share(c, i);
        if (!(share > 0)) continue;
        chosen = i;
        running += share;
        if (u < running) break;
    }
    if (!chosen) return {};
    const uint32_t group = c.lights.empty() ? static_cast<uint32_t>(*chosen) : c.lights[*chosen];
    return SampledLight{LightId(group), GroupPMF(query, c, group)};
}

std::optional<SampledLight> VisibilityOctreeLightSampler::Sample(const LightQuery &query, Float u) const {
    if (groups_.Size() == 0) return {};
    SampledLight group{LightId(0u), 1};
    if (groups_.Size() > 1) {
        std::optional<SampledLight> chosen = SampleGroup(query, u);
        if (!chosen) return {};
        group = *chosen;
    }
    std::optional<SampledLight> light = interior_.Sample(group.light.value, query, MeshGroups::InnerNumber(u, query.p));
    if (light) light->pmf *= group.pmf;
    return light;
}

Float VisibilityOctreeLightSampler::PMF(const LightQuery &query, LightId light) const {
    const Float inner = interior_.PMF(query, light);
    if (groups_.Size() <= 1 || !(inner > 0)) return inner;
    Choice c;
    Weigh(query, &c);
    return inner * GroupPMF(query, c, groups_.GroupOf(light));
}

void VisibilityOctreeLightSampler::Report(nlohmann::ordered_json &report) const {
    report["parameters"] = EffectiveParams(params_).dump();
    report["groups"] = groups_.Size();
    report["lights"] = groups_.LightCount();
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
