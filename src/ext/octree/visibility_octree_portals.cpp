#include "ext/octree/visibility_octree_light_sampler.h"

namespace ext {

void VisibilityOctreeLightSampler::WeighPortals(const LightQuery &query, LightMemory &memory, Candidates *c) const {
    c->portals = portals_.Weigh(query, memory);
    c->totalCount = c->localCount + portals_.Count();
    for (size_t k = 0; k < portals_.Count(); ++k) {
        c->g[c->localCount + k] = c->portals->g[k];
        c->w[c->localCount + k] = c->portals->w[k];
    }
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
