#include "ext/octree/visibility_octree_light_sampler.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "ext/octree/prepass_effort.h"
#include "ext/octree/visibility_records.h"
#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/bxdfs/henyey_greenstein.h"
#include "pbrt/core/effective_params_text.h"
#include "pbrt/lightsamplers/weighted_choice.h"

namespace ext {

namespace {

double SecondsSince(std::chrono::steady_clock::time_point t) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
}

/// After these numbers of samples per pixel the tree learns from the render's shadow rays, if at least three times as
/// many samples are still to come.
constexpr int kLearnAfter[] = {1, 4, 16, 64};
/// Where more of the rays towards the skies leave the scene, skies stay whole: in direct light, and where paths bounce.
/// There most of the noise is theirs, and windows pay only where less of the sky is seen.
constexpr double kMaxSeen = 0.3, kMaxSeenWithBounces = 0.005;
/// Windows are looked for from so many vertices of the prepass, if there are as many.
constexpr size_t kWindowVertices = 4096;
/// At most this many shadow rays are kept from one learning to the next.
constexpr size_t kMaxFound = 400000;
/// Inside media with a larger mean cosine than this the choice of lights follows the phase function:
/// below, that costs as much time as it takes off the error.
constexpr Float kPeaked = 0.6f;

Float FloorOf(const OctreeParams &params) { return params.floor > 0 ? params.floor : kVisibilityFloor; }

/// Whether an emissive mesh is one light. If all primitives that emit fit into one packet, they are all weighed at once
/// instead, which takes less time than to choose a mesh and then one of its primitives.
bool MeshesAreLights(const LightTable &lights, const OctreeParams &params) {
    return params.meshlights && (lights.Wholes().Size() <= 1 || lights.Parts().Size() > EmitterPacket::kLanes);
}

bool HasLamps(const LightTable &lights) {
    const LightGroups &wholes = lights.Wholes();
    for (uint32_t g = 0; g < wholes.Size(); ++g)
        if (const LightCandidate c = wholes.Candidate(g); !c.infinite && c.power > 0) return true;
    return false;
}

/// The skies that windows are looked for. Where lamps shine as well, they cost more than they gain: the noise of the
/// sky is only a part there.
std::vector<LightId> SkiesFor(const LightTable &lights, const OctreeParams &params) {
    if (params.windows == "never" || (params.windows == "auto" && HasLamps(lights))) return {};
    return WindowChoice::SkiesOf(lights);
}

}  // namespace

VisibilityOctreeLightSampler::VisibilityOctreeLightSampler(const LightTable &lights, const OctreeParams &params)
    : InteriorLightSampler(lights, MeshesAreLights(lights, params), params.interior),
      params_(params),
      floor_(FloorOf(params)),
      skies_(SkiesFor(lights, params)),
      importance_(groups_) {
    if (groups_.Size() > kMax) lightTree_ = std::make_unique<LightTree>(LampEmitters());
}

std::vector<Emitter> VisibilityOctreeLightSampler::LampEmitters() const {
    std::vector<Emitter> emitters = GroupImportance::EmittersOf(groups_);
    for (const uint32_t group : skyGroups_) emitters[group] = {};
    return emitters;
}

VisibilityOctreeLightSampler::~VisibilityOctreeLightSampler() = default;

double VisibilityOctreeLightSampler::PathsPerPixel(const PrepareContext &context) const {
    if (params_.prepassspp > 0) return params_.prepassspp;
    PrepassEffort effort;
    effort.lights = groups_.Size();
    effort.triesPerVertex = Tries();
    effort.skyTries = skies_.size() * kSkyRaysPerVertex;
    effort.depth = std::min(params_.depth, std::max(1, context.maxDepth));
    effort.pixels = static_cast<double>(std::max<int64_t>(1, context.pixelBounds.Area()));
    effort.samplesPerPixel = context.samplesPerPixel;
    effort.budget = static_cast<double>(params_.budget);
    return effort.PathsPerPixel();
}

void VisibilityOctreeLightSampler::Prepare(PrepareContext &context) {
    if (windows_) UseWindows(nullptr);  // it was prepared before
    if (context.learned) return LoadLearned(context, *context.learned);
    if (groups_.Size() <= 1 && skies_.empty()) return;
    auto start = std::chrono::steady_clock::now();
    depth_ = std::min(params_.depth, std::max(1, context.maxDepth));
    sceneBounds_ = context.scene.Bounds();
    pixels_ = context.pixelBounds;
    samplesPerPixel_ = context.samplesPerPixel;
    std::vector<PrepassVertex> vertices = TracePrepassPaths(context, PathsPerPixel(context), depth_);
    if (context.progress.Cancelled()) return;
    if (!skies_.empty()) LookForWindows(context, vertices);
    if (context.progress.Cancelled()) return;
    if (groups_.Size() > std::max<size_t>(SkyCount(), 1)) {
        const auto media = std::stable_partition(vertices.begin(), vertices.end(),
                                                 [](const PrepassVertex &vertex) { return !vertex.phase; });
        auto trace = [&](auto begin, auto end) {
            return TraceVisibility(context, {begin, end}, groups_, importance_, interior_, lightTree_.get(), Tries());
        };
        onSurfaces_.known = trace(vertices.begin(), media);
        if (media != vertices.end()) inMedia_.known = trace(media, vertices.end());
        prepassRecords_ = onSurfaces_.known.records.size() + inMedia_.known.records.size();
        prepassTries_ = TryCount();
    }
    prepassSeconds_ = SecondsSince(start);
    if (context.progress.Cancelled()) return;

    start = std::chrono::steady_clock::now();
    context.progress.BeginPhase("octree", 0);
    if (Build(params_.records, context.progress)) BeginLearning(0);
    buildSeconds_ = SecondsSince(start);
    context.progress.EndPhase();
}

void VisibilityOctreeLightSampler::LookForWindows(PrepareContext &context, std::span<const PrepassVertex> vertices) {
    const auto start = std::chrono::steady_clock::now();
    const bool isDirect = context.maxDepth <= 1 || params_.windows == "always";
    const double most = isDirect ? kMaxSeen : kMaxSeenWithBounces;
    std::vector<SkyRay> rays;
    const auto isMoreSeenThan = [&](double share, size_t count) {
        rays = TraceSkyRays(context, skies_, vertices, count);
        const auto left = std::ranges::count_if(rays, [](const SkyRay &ray) { return ray.left; });
        skySeenShare_ = static_cast<double>(left) / static_cast<double>(std::max<size_t>(rays.size(), 1));
        return context.progress.Cancelled() || skySeenShare_ > share;
    };
    // Under an open sky a few vertices say enough.
    if (!isMoreSeenThan(2 * most, kWindowVertices / 16) && !isMoreSeenThan(most, kWindowVertices)) {
        std::unique_ptr<WindowChoice> windows = MakeWindows();
        if (windows->Find(context, rays, vertices)) UseWindows(std::move(windows));
    }
    skySeconds_ = SecondsSince(start);
}

std::unique_ptr<WindowChoice> VisibilityOctreeLightSampler::MakeWindows() const {
    return std::make_unique<WindowChoice>(groups_.Lights(), skies_, floor_);
}

void VisibilityOctreeLightSampler::UseWindows(std::unique_ptr<WindowChoice> windows) {
    windows_ = std::move(windows);
    skyGroups_.clear();
    if (windows_)
        for (const LightId sky : skies_) skyGroups_.push_back(groups_.GroupOf(sky));
    SetChoosesSkyParts(windows_ != nullptr);
    const std::vector<Emitter> lamps = LampEmitters();
    importance_ = GroupImportance(lamps);
    if (lightTree_) lightTree_ = std::make_unique<LightTree>(lamps);
}

std::optional<VisibilityOctreeLightSampler::Knowledge> VisibilityOctreeLightSampler::Built(
    const Knowledge &from, int records, const Progress &progress) const {
    Knowledge made;
    if (from.known.records.empty()) return made;
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
    VisibilityTreeBuilder builder(sceneBounds_, from.known.records, from.known.tries, settings);
    std::optional<VisibilityTree> tree = builder.Build([&] { return progress.Cancelled(); });
    if (!tree) return {};
    made.tree = std::move(*tree);
    made.learned = true;
    made.leaves = builder.Leaves();
    made.recordsPerNode = builder.RecordsPerNode();
    made.leavesBefore = builder.LeavesBeforePruning();
    return made;
}

bool VisibilityOctreeLightSampler::Build(int records, const Progress &progress) {
    std::optional<Knowledge> surfaces = Built(onSurfaces_, records, progress);
    std::optional<Knowledge> media = surfaces ? Built(inMedia_, records, progress) : std::nullopt;
    if (!surfaces || !media) return false;
    surfaces->known = std::move(onSurfaces_.known);
    media->known = std::move(inMedia_.known);
    onSurfaces_ = std::move(*surfaces);
    inMedia_ = std::move(*media);
    return true;
}

std::optional<std::string> VisibilityOctreeLightSampler::TakeUpLearning(const PrepareContext &context) {
    if (nextLearning_ == 0) return {};
    const auto next = std::ranges::find(kLearnAfter, nextLearning_);
    if (!IsUpdated() || next == std::end(kLearnAfter)) return "learning is due after a wrong number of samples";
    if (pixels_.low != context.pixelBounds.low || pixels_.high != context.pixelBounds.high ||
        depth_ != std::min(params_.depth, std::max(1, context.maxDepth)) || samplesPerPixel_ < nextLearning_)
        return "it was learned for other pixels or paths";
    found_.Begin(pixels_, next == std::begin(kLearnAfter) ? 0 : next[-1], nextLearning_, depth_, kMaxFound);
    return {};
}

void VisibilityOctreeLightSampler::BeginLearning(int first) {
    const auto next = std::ranges::upper_bound(kLearnAfter, first);
    nextLearning_ = IsUpdated() && next != std::end(kLearnAfter) && 4 * *next <= samplesPerPixel_ ? *next : 0;
    if (nextLearning_ == 0) return EndLearning();
    found_.Begin(pixels_, first, nextLearning_, depth_, kMaxFound);
}

void VisibilityOctreeLightSampler::EndLearning() {
    nextLearning_ = 0;
    found_.End();
    onSurfaces_.known = inMedia_.known = {};
}

void VisibilityOctreeLightSampler::RecordLightSample(PathPlaces &path, const LightQuery &query,
                                                     const SampledLight &light, const SampledSpectrum &found) {
    if (path.next >= path.end || !(light.unoccluded > 0)) return;
    const auto ratio = static_cast<Float>(RootMeanSquare(found) / groups_.Lights().Unit() / double(light.unoccluded));
    const Float weight = light.weight / static_cast<Float>(Tries());
    if (!std::isfinite(ratio) || !std::isfinite(weight)) return;
    found_.Add(path, query.p, query.ns == Normal3(0), {groups_.GroupOf(light.light), weight, weight, ratio});
}

void VisibilityOctreeLightSampler::Update(const Progress &progress) {
    if (progress.Cancelled()) return;
    const auto start = std::chrono::steady_clock::now();
    Knowledge *const kinds[] = {&onSurfaces_, &inMedia_};
    size_t recordsBefore[2], triesBefore[2];
    for (size_t k = 0; k < 2; ++k) {
        VisibilityRecords &known = kinds[k]->known;
        recordsBefore[k] = known.records.size();
        triesBefore[k] = known.tries.size();
        found_.AppendTo(&known, k == 1);
    }
    // Cells may hold four times as many records as in the first build: the tree is as good, and built in half the time.
    if (!Build(4 * params_.records, progress)) {
        for (size_t k = 0; k < 2; ++k) {
            kinds[k]->known.records.resize(recordsBefore[k]);
            kinds[k]->known.tries.resize(triesBefore[k]);
        }
        return;
    }
    learnedTries_ = TryCount() - prepassTries_;
    learningSeconds_ += SecondsSince(start);
    BeginLearning(nextLearning_);
}

const void *VisibilityOctreeLightSampler::WeighGroups(const LightQuery &query, LightMemory &memory) const {
    auto *c = memory.Make<Choice>();
    const Knowledge &knowledge = KnowledgeAt(query);
    const bool learned = knowledge.learned;
    VisibilityTree::Row row;
    if (learned) row = knowledge.tree.RowAt(query.p);
    if (lightTree_) {
        c->nodes = learned ? row.nodes : lightTree_->BaseCut();
        c->count = c->nodes.size();
        c->lampG = lightTree_->Evaluate(query, c->nodes, c->g);
    } else if (groups_.Size() > SkyCount()) {
        c->count = groups_.Size();
        c->lampG = importance_.Evaluate(query, c->g);
    }
    const Float *decode = VisibilityTree::Table().data();
    for (size_t i = 0; i < c->count; ++i) c->w[i] = learned ? c->g[i] * decode[row.codes[i]] : c->g[i];
    c->all = c->count + SkyCount();
    c->sumG = c->lampG;
    if (windows_) {
        c->sky = windows_->Weigh(query, memory);
        for (size_t k = 0; k < SkyCount(); ++k) {
            c->w[c->count + k] = c->sky->w[k];
            c->sumG += c->g[c->count + k] = c->sky->g[k];
        }
    }
    c->SumUp();
    const bool isDirectional =
        query.phase ? std::abs(query.phase->G()) > kPeaked : query.bsdf && query.bsdf->IsDirectional();
    if (params_.bsdf && isDirectional) FollowScattering(query, c);
    // sumW is 0 only where sumG is.
    c->perW = c->sumW > 0 ? (1 - floor_) / c->sumW : 0;
    c->perG = c->sumW > 0 ? floor_ / c->sumG : 0;
    return c;
}

void VisibilityOctreeLightSampler::FollowScattering(const LightQuery &query, Choice *c) const {
    // A light's middle may lie outside the lobe while its rim is inside, so a part of every weight ignores the lobe.
    constexpr Float kAlike = 0.1f;
    // For lights of less weight than this the lobe is not evaluated, because that takes as long as all the rest of the
    // choice. None of them makes much of the noise, and BSDF samples find what is brightest.
    const Float worthLooking = c->sumW * std::min(Float(0.01), Float(0.15) / static_cast<Float>(c->count));
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
    if (query.phase)
        for (size_t k = 0; k < count; ++k) f[k] = query.phase->P(query.wo, wi[k]);
    else
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
    c->SumUp();
}

std::optional<GroupLightSampler::ChosenGroup> VisibilityOctreeLightSampler::ChooseGroup(const LightQuery &query,
                                                                                        const void *weights,
                                                                                        Float u) const {
    const Choice &c = *static_cast<const Choice *>(weights);
    const auto chosen = ChooseByWeight<Float>(c.all, u, [&](uint32_t i) { return c.Share(i); });
    if (!chosen) return {};
    const Float share = chosen.weight, g = c.g[chosen.index];
    const Float inside = LightGroups::InnerNumber(u, query.p, (chosen.before + share) - share, share);
    auto choose = [&](uint32_t group, Float pmf, Float inner, Float unoccluded) {
        return ChosenGroup{group, pmf, inner, unoccluded, unoccluded / (c.lampG * pmf)};
    };
    if (chosen.index >= c.count) return ChosenGroup{skyGroups_[chosen.index - c.count], share, inside, 0, 0};
    if (!lightTree_) return choose(chosen.index, share, inside, g);
    const uint32_t node = c.nodes[chosen.index];
    if (lightTree_->IsLight(node)) return choose(lightTree_->LightAt(lightTree_->At(node).begin), share, inside, g);
    std::optional<SampledLight> light = lightTree_->SampleWithin(node, query, inside);
    if (!light) return {};
    return choose(light->light.value, share * light->pmf, LightGroups::InnerNumber(u, query.p), light->unoccluded);
}

Float VisibilityOctreeLightSampler::GroupProbability(const LightQuery &query, const void *weights,
                                                     uint32_t group) const {
    const Choice &c = *static_cast<const Choice *>(weights);
    if (const size_t k = SkyOfGroup(group); k < SkyCount()) return c.Share(c.count + k);
    if (lightTree_ && lightTree_->PositionOf(group) == LightTree::kNowhere) return 0;
    if (!lightTree_) return c.Share(group);
    const uint32_t position = lightTree_->PositionOf(group);
    const size_t i = lightTree_->FindInCut(c.nodes, position);
    const Float share = c.Share(i);
    if (!(share > 0)) return 0;
    return lightTree_->IsLight(c.nodes[i]) ? share : share * lightTree_->PMFWithin(c.nodes[i], query, position);
}

size_t VisibilityOctreeLightSampler::SkyOfGroup(uint32_t group) const {
    size_t k = 0;
    while (k < skyGroups_.size() && skyGroups_[k] != group) ++k;
    return k;
}

std::optional<SampledLight> VisibilityOctreeLightSampler::ChooseInside(const LightQuery &query, const void *weights,
                                                                       uint32_t group, Float u, Point2 *uPoint) const {
    const size_t k = SkyOfGroup(group);
    if (k < SkyCount()) return windows_->Sample(*static_cast<const Choice *>(weights)->sky, k, uPoint);
    return InteriorLightSampler::ChooseInside(query, weights, group, u, uPoint);
}

Float VisibilityOctreeLightSampler::ProbabilityInside(const LightQuery &query, const void *weights,
                                                      LightId light) const {
    const size_t k = SkyOfGroup(groups_.GroupOf(light));
    if (k < SkyCount()) return windows_->PMF(*static_cast<const Choice *>(weights)->sky, k, light);
    if (light.value >= groups_.LightCount()) return 0;
    return InteriorLightSampler::ProbabilityInside(query, weights, light);
}

LightId VisibilityOctreeLightSampler::PartOf(const LightQuery &, const void *, LightId infinite, const Point3 &p,
                                             const Vector3 &d) const {
    const size_t k = SkyOfGroup(groups_.GroupOf(infinite));
    return k < SkyCount() ? windows_->PartTowards(k, p, d) : infinite;
}

std::vector<LightId> VisibilityOctreeLightSampler::SkyPartsOf(LightId infinite) const {
    const size_t k = SkyOfGroup(groups_.GroupOf(infinite));
    return k < SkyCount() ? windows_->PartsOf(k) : std::vector<LightId>();
}

void VisibilityOctreeLightSampler::Report(nlohmann::ordered_json &report) const {
    report["parameters"] = EffectiveParamsText(params_);
    GroupLightSampler::Report(report);
    report["prepassVertices"] = prepassRecords_;
    report["prepassShadowRays"] = prepassTries_;
    report["prepassSeconds"] = prepassSeconds_;
    report["octreeBuildSeconds"] = buildSeconds_;
    if (learnedTries_ > 0) {
        report["learnedFromShadowRays"] = learnedTries_;
        report["learningSeconds"] = learningSeconds_;
    }
    if (skySeconds_ > 0) {
        report["skySeenShare"] = skySeenShare_;
        if (windows_) windows_->Report(report);
        report["skySeconds"] = skySeconds_;
    }
    const VisibilityTree &surfaces = onSurfaces_.tree, &media = inMedia_.tree;
    report["leavesBeforePruning"] = onSurfaces_.leavesBefore + inMedia_.leavesBefore;
    report["leaves"] = surfaces.LeafCount() + media.LeafCount();
    if (inMedia_.learned) report["leavesInMedia"] = media.LeafCount();
    report["rows"] = surfaces.RowCount() + media.RowCount();
    report["depth"] = std::max(surfaces.Depth(), media.Depth());
    report["bytes"] = surfaces.Bytes() + media.Bytes() + importance_.Bytes() + interior_.Bytes() +
                      (lightTree_ ? lightTree_->Bytes() : 0) + (windows_ ? windows_->Bytes() : 0);
}

}  // namespace ext
