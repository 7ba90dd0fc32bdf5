#include "ext/octree/visibility_octree_light_sampler.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "ext/octree/prepass_effort.h"
#include "ext/octree/visibility_records.h"
#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/lightsamplers/weighted_choice.h"

namespace ext {

namespace {

double SecondsSince(std::chrono::steady_clock::time_point t) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
}

/// After these numbers of samples per pixel the tree learns from the render's shadow rays, if at least three times as
/// many samples are still to come.
constexpr int kLearnAfter[] = {1, 4, 16, 64};
/// At most this many shadow rays are kept from one learning to the next.
constexpr size_t kMaxFound = 400000;

}  // namespace

VisibilityOctreeLightSampler::VisibilityOctreeLightSampler(const LightTable &lights, const OctreeParams &params)
    : InteriorLightSampler(lights, params.meshlights, params.interior),
      params_(params),
      floor_(params.floor > 0 ? params.floor : kVisibilityFloor),
      importance_(groups_) {
    if (groups_.Size() > kMax) lightTree_ = std::make_unique<LightTree>(GroupImportance::EmittersOf(groups_));
}

VisibilityOctreeLightSampler::~VisibilityOctreeLightSampler() = default;

double VisibilityOctreeLightSampler::PathsPerPixel(const PrepareContext &context) const {
    if (params_.prepassspp > 0) return params_.prepassspp;
    PrepassEffort effort;
    effort.lights = groups_.Size();
    effort.triesPerVertex = Tries();
    effort.depth = std::min(params_.depth, std::max(1, context.maxDepth));
    effort.pixels = static_cast<double>(std::max<int64_t>(1, context.pixelBounds.Area()));
    effort.samplesPerPixel = context.samplesPerPixel;
    effort.budget = static_cast<double>(params_.budget);
    return effort.PathsPerPixel();
}

void VisibilityOctreeLightSampler::Prepare(PrepareContext &context) {
    if (groups_.Size() <= 1) return;
    auto start = std::chrono::steady_clock::now();
    depth_ = std::min(params_.depth, std::max(1, context.maxDepth));
    sceneBounds_ = context.scene.Bounds();
    pixels_ = context.pixelBounds;
    samplesPerPixel_ = context.samplesPerPixel;
    std::vector<PrepassVertex> vertices = TracePrepassPaths(context, PathsPerPixel(context), depth_);
    if (context.progress.Cancelled()) return;
    known_ = TraceVisibility(context, vertices, groups_, importance_, interior_, lightTree_.get(), Tries());
    prepassRecords_ = known_.records.size();
    prepassTries_ = known_.tries.size();
    prepassSeconds_ = SecondsSince(start);
    if (context.progress.Cancelled()) return;

    start = std::chrono::steady_clock::now();
    context.progress.BeginPhase("octree", 0);
    if (Build(params_.records, context.progress)) BeginLearning(0);
    buildSeconds_ = SecondsSince(start);
    context.progress.EndPhase();
}

bool VisibilityOctreeLightSampler::Build(int records, const Progress &progress) {
    VisibilityBuildSettings settings;
    settings.lightCount = static_cast<int>(groups_.Size());
    settings.lights = lightTree_.get();
    settings.cut = params_.cut;
    settings.records = records;
    settings.triesPerRecord = static_cast<int>(Tries());
    settings.shrinkage = params_.shrinkage;
    settings.pruneGain = params_.prunegain;
    settings.secondMoment = params_.secondmoment;
    settings.floor = floor_;
    VisibilityTreeBuilder builder(sceneBounds_, known_.records, known_.tries, settings);
    std::optional<VisibilityTree> tree = builder.Build([&] { return progress.Cancelled(); });
    if (!tree) return false;
    tree_ = std::move(*tree);
    leavesBefore_ = builder.LeavesBeforePruning();
    leaves_ = builder.Leaves();
    recordsPerNode_ = builder.RecordsPerNode();
    learned_ = true;
    return true;
}

void VisibilityOctreeLightSampler::BeginLearning(int first) {
    const auto *next = std::upper_bound(std::begin(kLearnAfter), std::end(kLearnAfter), first);
    nextLearning_ = Learner() && next != std::end(kLearnAfter) && 4 * *next <= samplesPerPixel_ ? *next : 0;
    if (nextLearning_ > 0) {
        found_.Begin(pixels_, first, nextLearning_, depth_, kMaxFound);
    } else {
        found_.End();
        known_ = {};
    }
}

void VisibilityOctreeLightSampler::Found(PathPlaces &path, const LightQuery &query, const SampledLight &light,
                                         const SampledSpectrum &found) {
    if (!(light.unoccluded > 0)) return;
    const Float ratio = RootMeanSquare(found) / light.unoccluded, weight = light.weight / static_cast<Float>(Tries());
    if (!std::isfinite(ratio) || !std::isfinite(weight)) return;
    found_.Add(path, query.p, {groups_.GroupOf(light.light), weight, weight, ratio});
}

void VisibilityOctreeLightSampler::Learn(const Progress &progress) {
    const auto start = std::chrono::steady_clock::now();
    const size_t recordsBefore = known_.records.size(), triesBefore = known_.tries.size();
    found_.AppendTo(&known_);
    // Cells may hold four times as many records as in the first build: the tree is as good, and built in half the time.
    if (!Build(4 * params_.records, progress)) {
        known_.records.resize(recordsBefore);
        known_.tries.resize(triesBefore);
        return;
    }
    learnedTries_ = known_.tries.size() - prepassTries_;
    BeginLearning(nextLearning_);
    learningSeconds_ += SecondsSince(start);
}

const void *VisibilityOctreeLightSampler::WeighGroups(const LightQuery &query, LightMemory &memory) const {
    auto *c = memory.Make<Choice>();
    VisibilityTree::Row row;
    if (learned_) row = tree_.RowAt(query.p);
    if (lightTree_) {
        c->nodes = learned_ ? row.nodes : lightTree_->BaseCut();
        c->count = c->nodes.size();
        c->sumG = lightTree_->Evaluate(query, c->nodes, c->g);
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
    c->perW = c->sumW > 0 ? (1 - floor_) / c->sumW : 0;
    c->perG = c->sumW > 0 ? floor_ / c->sumG : 0;
    return c;
}

void VisibilityOctreeLightSampler::FollowBsdf(const LightQuery &query, Choice *c) const {
    // A light's middle may lie outside the lobe while its rim is inside, so a part of every weight ignores the BSDF.
    constexpr Float kAlike = 0.1f;
    // For lights of less weight than this the BSDF is not evaluated.
    const Float worthLooking = c->sumW * 1e-3f;
    Vector3 wi[kMax];
    uint8_t looked[kMax];
    size_t count = 0;
    for (size_t i = 0; i < c->count; ++i) {
        if (!(c->w[i] > worthLooking)) continue;
        // The middle of a node of several lights says little about their directions.
        if (lightTree_ && !lightTree_->IsLight(c->nodes[i])) continue;
        wi[count] = importance_.DirectionTo(
            query.p, lightTree_ ? lightTree_->LightAt(lightTree_->At(c->nodes[i]).begin) : static_cast<uint32_t>(i));
        if (wi[count] != Vector3(0)) looked[count++] = static_cast<uint8_t>(i);
    }
    Float f[kMax];
    query.bsdf->ApproximateF(query.wo, {wi, count}, f);
    Float weighted = 0, weights = 0;
    for (size_t k = 0; k < count; ++k) {
        weighted += f[k] * c->w[looked[k]];
        weights += c->w[looked[k]];
    }
    const Float mean = weights > 0 ? weighted / weights : 0;
    if (!(mean > 0) || !std::isfinite(mean)) return;
    // Relative to the mean, so that these lights together keep their weight against those without an f.
    for (size_t k = 0; k < count; ++k) c->w[looked[k]] *= (f[k] / mean + kAlike) / (1 + kAlike);
    c->sumW = 0;
    for (size_t i = 0; i < c->count; ++i) c->sumW += c->w[i];
}

std::optional<GroupLightSampler::ChosenGroup> VisibilityOctreeLightSampler::ChooseGroup(const LightQuery &query,
                                                                                        const void *weights,
                                                                                        Float u) const {
    const Choice &c = *static_cast<const Choice *>(weights);
    const auto chosen = ChooseByWeight<Float>(c.count, u, [&](uint32_t i) { return c.Share(i); });
    if (!chosen) return {};
    const Float share = chosen->weight, g = c.g[chosen->index];
    const Float inside = LightGroups::InnerNumber(u, query.p, (chosen->before + share) - share, share);
    auto choose = [&](uint32_t group, Float pmf, Float inner, Float unoccluded) {
        return ChosenGroup{group, pmf, inner, unoccluded, unoccluded / (c.sumG * pmf)};
    };
    if (!lightTree_) return choose(chosen->index, share, inside, g);
    const uint32_t node = c.nodes[chosen->index];
    if (lightTree_->IsLight(node)) return choose(lightTree_->LightAt(lightTree_->At(node).begin), share, inside, g);
    std::optional<SampledLight> light = lightTree_->SampleWithin(node, query, inside);
    if (!light) return {};
    return choose(light->light.value, share * light->pmf, LightGroups::InnerNumber(u, query.p), light->unoccluded);
}

Float VisibilityOctreeLightSampler::GroupProbability(const LightQuery &query, const void *weights,
                                                     uint32_t group) const {
    if (lightTree_ && lightTree_->PositionOf(group) == LightTree::kNowhere) return 0;
    const Choice &c = *static_cast<const Choice *>(weights);
    if (!lightTree_) return c.Share(group);
    const uint32_t position = lightTree_->PositionOf(group);
    const size_t i = lightTree_->FindInCut(c.nodes, position);
    const Float share = c.Share(i);
    if (!(share > 0)) return 0;
    return lightTree_->IsLight(c.nodes[i]) ? share : share * lightTree_->PMFWithin(c.nodes[i], query, position);
}

void VisibilityOctreeLightSampler::Report(nlohmann::ordered_json &report) const {
    report["parameters"] = EffectiveParams(params_).dump();
    GroupLightSampler::Report(report);
    report["prepassVertices"] = prepassRecords_;
    report["prepassShadowRays"] = prepassTries_;
    report["prepassSeconds"] = prepassSeconds_;
    report["octreeBuildSeconds"] = buildSeconds_;
    if (learnedTries_ > 0) {
        report["learnedFromShadowRays"] = learnedTries_;
        report["learningSeconds"] = learningSeconds_;
    }
    report["leavesBeforePruning"] = leavesBefore_;
    report["leaves"] = tree_.LeafCount();
    report["rows"] = tree_.RowCount();
    report["depth"] = tree_.Depth();
    report["bytes"] = tree_.Bytes() + importance_.Bytes() + interior_.Bytes() + (lightTree_ ? lightTree_->Bytes() : 0);
}

}  // namespace ext
