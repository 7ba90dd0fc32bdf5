#include "pbrt/lightsamplers/exhaustive_light_sampler.h"

#include <nlohmann/json.hpp>

#include "pbrt/lightsamplers/weighted_choice.h"

namespace pbrt {

ExhaustiveLightSampler::ExhaustiveLightSampler(const LightGroups &groups)
    : GroupLightSampler(groups, true), position_(groups.Size(), kNever) {
    for (uint32_t i = 0; i < groups.Size(); ++i) {
        const LightCandidate c = groups.Candidate(i);
        if (c.infinite || !c.bounds || !(c.bounds->phi > 0)) continue;
        size_t lane = lights_.size();
        position_[i] = uint32_t(lane);
        if (lane % kLanes == 0) packets_.emplace_back();
        packets_.back().Set(int(lane % kLanes), c.bounds->Sphere());
        lights_.push_back(i);
    }
    blockSize_ = std::max<size_t>(1, (packets_.size() + kBlocks - 1) / kBlocks);
    infinite_ = InfiniteShare(groups, !lights_.empty());
}

const void *ExhaustiveLightSampler::WeighGroups(const LightQuery &query, LightMemory &memory) const {
    auto *sums = memory.Make<Sums>();
    sums->total = 0;
    for (size_t block = 0, i = 0; i < packets_.size(); ++block) {
        double sum = 0;
        for (size_t end = std::min(i + blockSize_, packets_.size()); i < end; ++i) {
            Float *w = sums->lane[block];
            packets_[i].Importances(query.p, query.n, w);
            for (size_t lane = 0; lane < kLanes; ++lane) sum += double(w[lane]);
        }
        sums->block[block] = sum;
        sums->total += sum;
    }
    return sums;
}

std::optional<GroupLightSampler::ChosenGroup> ExhaustiveLightSampler::ChooseGroup(const LightQuery &query,
                                                                                  const void *weights, Float u) const {
    const Sums &sums = *static_cast<const Sums *>(weights);
    auto rest = double(u);
    if (!(infinite_.Pmf() > 0)) return {};
    uint32_t infinite;
    if (!infinite_.ChooseBounded(rest, &infinite)) return ChosenGroup{infinite, infinite_.Pmf(), InnerNumber(query, u)};
    if (!(sums.total > 0)) return {};

    const double target = rest * sums.total;
    const size_t blocks = (packets_.size() + blockSize_ - 1) / blockSize_;
    const auto block = ChooseByWeight<double>(blocks, target, [&](uint32_t b) { return sums.block[b]; });
    if (!block) return {};
    const size_t first = block.index * blockSize_, end = std::min(first + blockSize_, packets_.size());
    Float scratch[kLanes];
    const Float *lanes = nullptr;
    const auto chosen = ChooseByWeight<double>((end - first) * kLanes, target,
                                               [&](uint32_t i) {
                                                   if (i % kLanes == 0)
                                                       lanes = Lanes(first + i / kLanes, query, sums, scratch);
                                                   return lanes[i % kLanes];
                                               },
                                               block.before);
    if (!chosen) return {};
    const Float pmf = infinite_.Pmf() * Float(double(chosen.weight) / sums.total);
    if (!(pmf > 0)) return {};
    return ChosenGroup{lights_[first * kLanes + chosen.index], pmf, InnerNumber(query, u)};
}

Float ExhaustiveLightSampler::GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const {
    const Sums &sums = *static_cast<const Sums *>(weights);
    const size_t position = position_[group];
    if (infinite_.Holds(group)) return infinite_.Pmf();
    if (position == kNever) return 0;
    Float scratch[kLanes];
    Float weight = Lanes(position / kLanes, query, sums, scratch)[position % kLanes];
    if (!(weight > 0)) return 0;
    return infinite_.Pmf() * Float(double(weight) / sums.total);
}

void ExhaustiveLightSampler::Report(nlohmann::ordered_json &json) const {
    json["bytes"] = packets_.capacity() * sizeof(LightPacket) +
                    (lights_.capacity() + position_.capacity()) * sizeof(uint32_t) + infinite_.Bytes();
    GroupLightSampler::Report(json);
}

}  // namespace pbrt
