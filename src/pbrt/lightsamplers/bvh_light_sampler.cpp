#include "pbrt/lightsamplers/bvh_light_sampler.h"

#include <nlohmann/json.hpp>

namespace pbrt {

BVHLightSampler::BVHLightSampler(std::span<const LightCandidate> candidates)
    : tree_(candidates), isInfinite_(candidates.size()) {
    std::vector<LightId> infinite;
    for (size_t i = 0; i < candidates.size(); ++i) {
        isInfinite_[i] = candidates[i].infinite;
        if (candidates[i].infinite) infinite.emplace_back(i);
    }
    infinite_ = InfiniteShare(std::move(infinite), !tree_.IsEmpty());
}

std::optional<SampledLight> BVHLightSampler::Choose(const LightQuery &query, const void *, Float u) const {
    auto rest = static_cast<double>(u);
    LightId light;
    if (!infinite_.ChooseBounded(rest, light)) {
        if (!light) return {};
        return SampledLight{light, infinite_.Pmf()};
    }
    const LightBvhNode *node = &tree_.Root();
    if (node->IsLeaf() && !(node->Sphere().Importance(query.p, query.ns) > 0)) return {};
    Float pmf = infinite_.Pmf();
    while (!node->IsLeaf()) {
        const LightBvhPair &pair = tree_.Pair(node->Link());
        Float w[2];
        pair.Importances(query.p, query.ns, w);
        Float sum = w[0] + w[1];
        if (!(sum > 0)) return {};
        double target = rest * static_cast<double>(sum);
        auto first = static_cast<double>(w[0]);
        int i = target < first ? 0 : 1;
        // `sum` is rounded: it may exceed the first weight although the second is 0, and what is left may exceed 1.
        if (!(w[i] > 0)) i = 1 - i;
        rest = std::clamp((i == 0 ? target : target - first) / static_cast<double>(w[i]), 0.0, 1.0);
        pmf *= w[i] / sum;
        node = &pair.child[i];
    }
    if (!(pmf > 0)) return {};
    return SampledLight{LightId(node->Link()), pmf};
}

Float BVHLightSampler::Probability(const LightQuery &query, const void *, LightId light) const {
    if (light.value >= isInfinite_.size()) return 0;
    if (isInfinite_[light.value]) return infinite_.Pmf();
    uint64_t trail = tree_.Trail(light);
    if (trail == LightBvh::NotInTree) return 0;
    const LightBvhNode *node = &tree_.Root();
    if (node->IsLeaf() && !(node->Sphere().Importance(query.p, query.ns) > 0)) return 0;
    Float pmf = infinite_.Pmf();
    for (; !node->IsLeaf(); trail >>= 1) {
        const LightBvhPair &pair = tree_.Pair(node->Link());
        Float w[2];
        pair.Importances(query.p, query.ns, w);
        auto i = static_cast<size_t>(trail & 1);
        if (!(w[i] > 0)) return 0;
        Float sum = w[0] + w[1];
        pmf *= w[i] / sum;
        node = &pair.child[i];
    }
    return pmf;
}

void BVHLightSampler::Report(nlohmann::ordered_json &json) const {
    json["nodes"] = tree_.IsEmpty() ? 0 : 2 * tree_.PairCount() + 1;
    json["depth"] = tree_.Depth();
    json["bytes"] = tree_.Bytes() + infinite_.Bytes();
}

}  // namespace pbrt
