#include "pbrt/lightsamplers/bvh_light_sampler.h"

#include <nlohmann/json.hpp>

namespace pbrt {

BVHLightSampler::BVHLightSampler(const LightGroups &groups) : GroupLightSampler(groups, true), isInfinite_(groups.Size()) {
    const std::vector<LightCandidate> candidates = groups.Candidates();
    tree_ = LightBvh(candidates);
    std::vector<uint32_t> infinite;
    for (size_t i = 0; i < candidates.size(); ++i) {
        isInfinite_[i] = candidates[i].infinite;
        if (candidates[i].infinite) infinite.emplace_back(i);
    }
    infinite_ = InfiniteShare(std::move(infinite), !tree_.IsEmpty());
}

std::optional<GroupLightSampler::ChosenGroup> BVHLightSampler::ChooseGroup(const LightQuery &query, const void *, Float u) const {
    auto rest = static_cast<double>(u);
    if (!(infinite_.Pmf() > 0)) return {};
    uint32_t infinite;
    if (!infinite_.ChooseBounded(rest, &infinite)) return ChosenGroup{infinite, infinite_.Pmf(), InnerNumber(query, u)};
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
    return ChosenGroup{node->Link(), pmf, InnerNumber(query, u)};
}

Float BVHLightSampler::GroupProbability(const LightQuery &query, const void *, uint32_t group) const {
    if (isInfinite_[group]) return infinite_.Pmf();
    uint64_t trail = tree_.Trail(group);
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
    GroupLightSampler::Report(json);
}

}  // namespace pbrt
