#include "pbrt/lightsamplers/exhaustive_light_sampler.h"

namespace pbrt {

ExhaustiveLightSampler::ExhaustiveLightSampler(std::span<const LightCandidate> candidates)
    : position_(candidates.size(), kNever) {
    std::vector<LightId> infinite;
    for (size_t i = 0; i < candidates.size(); ++i) {
        const LightCandidate &c = candidates[i];
        if (c.infinite) {
            position_[i] = kInfinite;
            infinite.emplace_back(i);
        } else if (c.bounds && c.bounds->phi > 0) {
            position_[i] = static_cast<uint32_t>(bounded_.size());
            bounded_.push_back(c.bounds->Sphere());
            lights_.push_back(static_cast<uint32_t>(i));
        }
    }
    blockSize_ = std::max<size_t>(1, (bounded_.size() + kBlocks - 1) / kBlocks);
    infinite_ = InfiniteShare(std::move(infinite), !bounded_.empty());
}

// Compiled once, so that all uses get the same bits.
[[gnu::noinline]] Float ExhaustiveLightSampler::Importance(size_t i, const LightQuery &query) const {
    return bounded_[i].Importance(query.p, query.n);
}

void ExhaustiveLightSampler::AddUp(const LightQuery &query, Sums *sums) const {
    sums->total = 0;
    for (size_t block = 0, i = 0; i < bounded_.size(); ++block) {
        double sum = 0;
        for (size_t end = std::min(i + blockSize_, bounded_.size()); i < end; ++i)
            sum += static_cast<double>(Importance(i, query));
        sums->block[block] = sum;
        sums->total += sum;
    }
}

std::optional<SampledLight> ExhaustiveLightSampler::Sample(const LightQuery &query, Float u) const {
    auto rest = static_cast<double>(u);
    LightId light;
    if (!infinite_.ChooseBounded(rest, light)) {
        if (!light) return {};
        return SampledLight{light, infinite_.Pmf()};
    }
    Sums sums;
    AddUp(query, &sums);
    if (!(sums.total > 0)) return {};

    // First the block, then the light in it; the last one that has any importance takes what rounding leaves over.
    double target = rest * sums.total;
    size_t blocks = (bounded_.size() + blockSize_ - 1) / blockSize_, chosenBlock = 0;
    double before = 0, beforeChosen = 0;
    for (size_t b = 0; b < blocks; ++b) {
        if (!(sums.block[b] > 0)) continue;
        chosenBlock = b;
        beforeChosen = before;
        before += sums.block[b];
        if (target < before) break;
    }
    size_t chosen = bounded_.size();
    Float weight = 0;
    before = beforeChosen;
    for (size_t i = chosenBlock * blockSize_, end = std::min(i + blockSize_, bounded_.size()); i < end; ++i) {
        Float w = Importance(i, query);
        if (!(w > 0)) continue;
        chosen = i;
        weight = w;
        before += static_cast<double>(w);
        if (target < before) break;
    }
    Float pmf = infinite_.Pmf() * static_cast<Float>(static_cast<double>(weight) / sums.total);
    if (!(pmf > 0)) return {};
    return SampledLight{LightId(lights_[chosen]), pmf};
}

Float ExhaustiveLightSampler::PMF(const LightQuery &query, LightId light) const {
    if (light.value >= position_.size() || position_[light.value] == kNever) return 0;
    if (position_[light.value] == kInfinite) return infinite_.Pmf();
    Float weight = Importance(position_[light.value], query);
    if (!(weight > 0)) return 0;
    Sums sums;
    AddUp(query, &sums);
    return infinite_.Pmf() * static_cast<Float>(static_cast<double>(weight) / sums.total);
}

void ExhaustiveLightSampler::Report(nlohmann::ordered_json &json) const {
    json["bytes"] = bounded_.capacity() * sizeof(LightSphere) + (lights_.capacity() + position_.capacity()) * sizeof(uint32_t) +
                    infinite_.Bytes();
}

}  // namespace pbrt
