#include "pbrt/lightsamplers/bvh_light_sampler.h"

#include <nlohmann/json.hpp>

#include "pbrt/lightsamplers/weighted_choice.h"

namespace pbrt {

BVHLightSampler::BVHLightSampler(const LightGroups &groups)
    : GroupLightSampler(groups, true), isInfinite_(groups.Size()) {
    const std::vector<LightCandidate> candidates = groups.Candidates();
    tree_ = LightBvh(candidates);
    std::vector<uint32_t> infinite;
    for (size_t i = 0; i < candidates.size(); ++i) {
        isInfinite_[i] = candidates[i].infinite;
        if (candidates[i].infinite) infinite.emplace_back(i);
    }
    infinite_ = InfiniteShare(std::move(infinite), !tree_.IsEmpty());
}

std::optional<GroupLightSampler::ChosenGroup> BVHLightSampler::ChooseGroup(const LightQuery &query, const void *,
                                                                           Float u) const {
    auto rest = double(u);
    if (!(infinite_.Pmf() > 0)) return {};
    uint32_t infinite;
    if (!infinite_.ChooseBounded(rest, &infinite)) return ChosenGroup{infinite, infinite_.Pmf(), InnerNumber(query, u)};
    if (!Reaches(query)) return {};
    const auto end = WalkDown(tree_, tree_.Root().LinkAndKind(), query, rest);
    if (!end) return {};
    const Float pmf = infinite_.Pmf() * end->pmf;
    if (!(pmf > 0)) return {};
    return ChosenGroup{LightBvh::Light(end->node), pmf, InnerNumber(query, u)};
}

bool BVHLightSampler::Reaches(const LightQuery &query) const {
    return !tree_.Root().IsLeaf() || tree_.Root().Sphere().Importance(query.p, query.ns) > 0;
}

Float BVHLightSampler::GroupProbability(const LightQuery &query, const void *, uint32_t group) const {
    if (isInfinite_[group]) return infinite_.Pmf();
    uint64_t trail = tree_.Trail(group);
    if (trail == LightBvh::NotInTree) return 0;
    if (!Reaches(query)) return 0;
    LightBvh::Node node = tree_.Root().LinkAndKind();
    const Float pmf = WalkProbability(tree_, &node, query, [&](LightBvh::Node, const LightBvh::Level &) {
        const auto i = uint32_t(trail & 1);
        trail >>= 1;
        return i;
    });
    return infinite_.Pmf() * pmf;
}

void BVHLightSampler::Report(nlohmann::ordered_json &json) const {
    json["nodes"] = tree_.IsEmpty() ? 0 : 2 * tree_.PairCount() + 1;
    json["depth"] = tree_.Depth();
    json["bytes"] = tree_.Bytes() + infinite_.Bytes();
    GroupLightSampler::Report(json);
}

}  // namespace pbrt
