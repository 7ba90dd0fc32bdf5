#include "ext/octree/visibility_octree_light_sampler.h"

#include <algorithm>

namespace ext {
namespace {

/// Mean cosine above which light selection in media includes the phase function; below, it costs what it gains.
constexpr Float kPeaked = 0.6f;
/// Part of a light's weight that ignores the lobe, relative to the rest at the mean over lights: a light's centre may
/// lie outside the lobe while its rim is inside.
constexpr Float kLobeFloor = 0.1f;

}  // namespace

const void *VisibilityOctreeLightSampler::WeighGroups(const LightQuery &query, LightMemory &memory) const {
    auto *c = memory.Make<Candidates>();
    WeighCandidates(query, model_.TreeAt(query), c);
    if (portals_.IsActive()) WeighPortals(query, memory, c);
    const bool isDirectional =
        query.phase ? std::abs(query.phase->G()) > kPeaked : query.bsdf && query.bsdf->IsDirectional();
    if (params_.bsdf && isDirectional) WeighScattering(query, c);
    const Float sumW = c->SumW(), sumG = std::accumulate(c->g + c->localCount, c->g + c->totalCount, c->localG);
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
        c->localCount = c->nodes.size();
        c->localG = lightTree_->Evaluate(query, c->nodes, c->g);
    } else if (groups_.Size() > portals_.Count()) {
        c->localCount = groups_.Size();
        c->localG = importance_.Evaluate(query, c->g);
    }
    c->totalCount = c->localCount;
    const Float *factor = VisibilityTree::Table().data();
    for (size_t i = 0; i < c->localCount; ++i) c->w[i] = visibility ? c->g[i] * factor[row.codes[i]] : c->g[i];
}

void VisibilityOctreeLightSampler::WeighScattering(const LightQuery &query, Candidates *c) const {
    // Lights below this weight skip the lobe evaluation, which costs as much as the rest of the selection. They
    // contribute little noise, and BSDF samples cover the brightest.
    const Float minWeight = c->SumW() * std::min(Float(0.01), Float(0.15) / Float(c->localCount));
    Vector3 wi[kMaxCandidates];
    uint8_t evaluated[kMaxCandidates];
    size_t evaluatedCount = 0;
    for (size_t i = 0; i < c->localCount; ++i) {
        if (!(c->w[i] > minWeight)) continue;
        // A node of several lights spans directions far from its centre.
        if (lightTree_ && !lightTree_->IsLight(c->nodes[i])) continue;
        wi[evaluatedCount] = importance_.DirectionTo(
            query.p, lightTree_ ? lightTree_->LightAt(lightTree_->At(c->nodes[i]).begin) : uint32_t(i));
        if (wi[evaluatedCount] != Vector3(0)) evaluated[evaluatedCount++] = uint8_t(i);
    }
    Float f[kMaxCandidates];
    if (query.phase)
        for (size_t k = 0; k < evaluatedCount; ++k) f[k] = query.phase->P(query.wo, wi[k]);
    else query.bsdf->ApproximateF(query.wo, {wi, evaluatedCount}, f);
    Float weighted = 0, weights = 0;
    for (size_t k = 0; k < evaluatedCount; ++k) {
        weighted += f[k] * c->w[evaluated[k]];
        weights += c->w[evaluated[k]];
    }
    const Float mean = weights > 0 ? weighted / weights : 0;
    if (!(mean > 0) || !std::isfinite(mean)) return;
    // Relative to the mean, which preserves the total weight of the evaluated lights against the others.
    for (size_t k = 0; k < evaluatedCount; ++k) c->w[evaluated[k]] *= (f[k] / mean + kLobeFloor) / (1 + kLobeFloor);
}

std::optional<GroupLightSampler::ChosenGroup> VisibilityOctreeLightSampler::ChooseGroup(const LightQuery &query,
                                                                                        const void *weights,
                                                                                        Float u) const {
    const Candidates &c = *static_cast<const Candidates *>(weights);
    const auto chosen = ChooseByWeight<Float>(c.totalCount, u, [&](uint32_t i) { return c.Probability(i); });
    if (!chosen) return {};
    const Float pmf = chosen.weight;
    if (chosen.index >= c.localCount)
        return ChosenGroup{portals_.GroupOf(chosen.index - c.localCount), pmf, 0, 0, 0};  // regions need no number
    const Float inner = LightGroups::InnerNumber(u, query.p, (chosen.before + pmf) - pmf, pmf);
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
    if (const size_t k = portals_.IndexOf(group); k < portals_.Count()) return c.Probability(c.localCount + k);
    if (!lightTree_) return c.Probability(group);
    const uint32_t position = lightTree_->PositionOf(group);
    if (position == LightTree::kNowhere) return 0;
    const size_t i = lightTree_->FindInCut(c.nodes, position);
    const Float pmf = c.Probability(i);
    if (!(pmf > 0)) return 0;
    return lightTree_->IsLight(c.nodes[i]) ? pmf : pmf * lightTree_->PMFWithin(c.nodes[i], query, position);
}

}  // namespace ext
