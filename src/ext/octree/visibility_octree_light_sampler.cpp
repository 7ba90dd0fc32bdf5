#include "ext/octree/visibility_octree_light_sampler.h"

#include <algorithm>
#include <numeric>

#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/bxdfs/henyey_greenstein.h"
#include "pbrt/lightsamplers/weighted_choice.h"

namespace ext {
namespace {

/// Mean cosine above which light selection in media includes the phase function; below, it costs what it gains.
constexpr Float kPeaked = 0.6f;

}  // namespace

Float VisibilityOctreeLightSampler::Candidates::SumW() const { return std::accumulate(w, w + all, Float(0)); }

const void *VisibilityOctreeLightSampler::WeighGroups(const LightQuery &query, LightMemory &memory) const {
    auto *c = memory.Make<Candidates>();
    WeighCandidates(query, model_.TreeAt(query), c);
    Float sumG = c->localG;
    if (portals_.IsActive()) {
        WeighPortals(query, memory, c);
        for (size_t i = c->count; i < c->all; ++i) sumG += c->g[i];
    }
    const bool isDirectional =
        query.phase ? std::abs(query.phase->G()) > kPeaked : query.bsdf && query.bsdf->IsDirectional();
    if (params_.bsdf && isDirectional) WeighScattering(query, c);
    const Float sumW = c->SumW();
    c->perW = sumW > 0 ? (1 - floor_) / sumW : 0;
    c->perG = sumW > 0 ? floor_ / sumG : 0;
    return c;
}

void VisibilityOctreeLightSampler::WeighCandidates(const LightQuery &query, const VisibilityTree *visibility,
                                                   Candidates *c) const {
    VisibilityTree::Row row;
    if (visibility) row = visibility->RowAt(query.p);
    if (lightTree_) {
        c->nodes = visibility ? row.nodes : lightTree_->BaseCut();
        c->count = c->nodes.size();
        c->localG = lightTree_->Evaluate(query, c->nodes, c->g);
    } else if (groups_.Size() > portals_.Count()) {
        c->count = groups_.Size();
        c->localG = importance_.Evaluate(query, c->g);
    }
    c->all = c->count;
    const Float *factor = VisibilityTree::Table().data();
    for (size_t i = 0; i < c->count; ++i) c->w[i] = visibility ? c->g[i] * factor[row.codes[i]] : c->g[i];
}

void VisibilityOctreeLightSampler::WeighPortals(const LightQuery &query, LightMemory &memory, Candidates *c) const {
    c->portals = portals_.Weigh(query, memory);
    c->all = c->count + portals_.Count();
    for (size_t k = 0; k < portals_.Count(); ++k) {
        c->g[c->count + k] = c->portals->g[k];
        c->w[c->count + k] = c->portals->w[k];
    }
}

void VisibilityOctreeLightSampler::WeighScattering(const LightQuery &query, Candidates *c) const {
    // A light's centre may lie outside the lobe while its rim is inside, so part of every weight ignores the lobe.
    constexpr Float kAlike = 0.1f;
    // Lights below this weight skip the lobe evaluation, which costs as much as the rest of the selection. They
    // contribute little noise, and BSDF samples cover the brightest.
    const Float least = c->SumW() * std::min(Float(0.01), Float(0.15) / Float(c->count));
    Vector3 wi[kMaxCandidates];
    uint8_t evaluated[kMaxCandidates];
    size_t count = 0;
    for (size_t i = 0; i < c->count; ++i) {
        if (!(c->w[i] > least)) continue;
        // A node of several lights spans directions far from its centre.
        if (lightTree_ && !lightTree_->IsLight(c->nodes[i])) continue;
        wi[count] = importance_.DirectionTo(
            query.p, lightTree_ ? lightTree_->LightAt(lightTree_->At(c->nodes[i]).begin) : uint32_t(i));
        if (wi[count] != Vector3(0)) evaluated[count++] = uint8_t(i);
    }
    Float f[kMaxCandidates];
    if (query.phase)
        for (size_t k = 0; k < count; ++k) f[k] = query.phase->P(query.wo, wi[k]);
    else query.bsdf->ApproximateF(query.wo, {wi, count}, f);
    Float weighted = 0, weights = 0;
    for (size_t k = 0; k < count; ++k) {
        weighted += f[k] * c->w[evaluated[k]];
        weights += c->w[evaluated[k]];
    }
    const Float mean = weights > 0 ? weighted / weights : 0;
    if (!(mean > 0) || !std::isfinite(mean)) return;
    // Relative to the mean, which preserves the total weight of the evaluated lights against the others.
    for (size_t k = 0; k < count; ++k) c->w[evaluated[k]] *= (f[k] / mean + kAlike) / (1 + kAlike);
}

std::optional<GroupLightSampler::ChosenGroup> VisibilityOctreeLightSampler::ChooseGroup(const LightQuery &query,
                                                                                        const void *weights,
                                                                                        Float u) const {
    const Candidates &c = *static_cast<const Candidates *>(weights);
    const auto chosen = ChooseByWeight<Float>(c.all, u, [&](uint32_t i) { return c.Probability(i); });
    if (!chosen) return {};
    const Float pmf = chosen.weight;
    const Float inner = LightGroups::InnerNumber(u, query.p, (chosen.before + pmf) - pmf, pmf);
    if (chosen.index >= c.count) return ChosenGroup{portals_.GroupOf(chosen.index - c.count), pmf, inner, 0, 0};
    const auto group = [&](uint32_t g, Float probability, Float number, Float unoccluded) {
        return ChosenGroup{g, probability, number, unoccluded, unoccluded / (c.localG * probability)};
    };
    if (!lightTree_) return group(chosen.index, pmf, inner, c.g[chosen.index]);
    const uint32_t node = c.nodes[chosen.index];
    if (lightTree_->IsLight(node))
        return group(lightTree_->LightAt(lightTree_->At(node).begin), pmf, inner, c.g[chosen.index]);
    std::optional<SampledLight> light = lightTree_->SampleWithin(node, query, inner);
    if (!light) return {};
    return group(light->light.value, pmf * light->pmf, LightGroups::InnerNumber(u, query.p), light->unoccluded);
}

Float VisibilityOctreeLightSampler::GroupProbability(const LightQuery &query, const void *weights,
                                                     uint32_t group) const {
    const Candidates &c = *static_cast<const Candidates *>(weights);
    if (const size_t k = portals_.IndexOf(group); k < portals_.Count()) return c.Probability(c.count + k);
    if (!lightTree_) return c.Probability(group);
    const uint32_t position = lightTree_->PositionOf(group);
    if (position == LightTree::kNowhere) return 0;
    const size_t i = lightTree_->FindInCut(c.nodes, position);
    const Float pmf = c.Probability(i);
    if (!(pmf > 0)) return 0;
    return lightTree_->IsLight(c.nodes[i]) ? pmf : pmf * lightTree_->PMFWithin(c.nodes[i], query, position);
}

std::optional<SampledLight> VisibilityOctreeLightSampler::ChooseInside(const LightQuery &query, const void *weights,
                                                                       uint32_t group, Float u, Point2 *uPoint) const {
    const size_t k = portals_.IndexOf(group);
    if (k < portals_.Count()) return portals_.Sample(*static_cast<const Candidates *>(weights)->portals, k, uPoint);
    return InteriorLightSampler::ChooseInside(query, weights, group, u, uPoint);
}

SampledLight VisibilityOctreeLightSampler::ChoiceTowards(const LightQuery &query, const void *weights, LightId infinite,
                                                         const Point3 &p, const Vector3 &d) const {
    const uint32_t group = groups_.GroupOf(infinite);
    const size_t k = portals_.IndexOf(group);
    if (k >= portals_.Count()) return InteriorLightSampler::ChoiceTowards(query, weights, infinite, p, d);
    SampledLight choice = portals_.Towards(*static_cast<const Candidates *>(weights)->portals, k, p, d);
    choice.pmf *= GroupProbability(query, weights, group);
    return choice;
}

}  // namespace ext
