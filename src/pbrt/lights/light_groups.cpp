#include "pbrt/lights/light_groups.h"

#include "pbrt/lights/light_table.h"

namespace pbrt {

LightGroups::LightGroups(const LightTable &lights, bool byLight) : lights_(lights), lightCount_(lights.Size()) {
    if (!byLight || lights.LightCount() == lights.Size()) return;
    const auto n = uint32_t(lights.Size());
    share_.resize(n);
    cdf_.resize(n);
    std::vector<double> powers;  // of the group's components
    for (uint32_t i = 0, end = 0; i < n; i = end) {
        LightCandidate group;
        double power = 0;
        powers.clear();
        for (end = i; end < n && lights.LightOf(LightId(end)) == lights.LightOf(LightId(i)); ++end) {
            const LightCandidate component = lights.Candidate(LightId(end));
            powers.push_back(double(component.power));
            power += powers.back();
            group.infinite = component.infinite;
            if (component.bounds)
                group.bounds = group.bounds ? Union(*group.bounds, *component.bounds) : *component.bounds;
        }
        group.power = Float(power);
        double running = 0;
        for (uint32_t k = i; k < end; ++k) {
            const double share = power > 0 ? powers[k - i] / power : 1.0 / double(end - i);
            running += share;
            share_[k] = Float(share);
            cdf_[k] = Float(running);
        }
        first_.push_back(i);
        candidates_.push_back(group);
    }
    first_.push_back(n);
}

LightCandidate LightGroups::Candidate(uint32_t group) const {
    return candidates_.empty() ? lights_.Candidate(LightId(group)) : candidates_[group];
}

std::vector<LightCandidate> LightGroups::Candidates() const {
    std::vector<LightCandidate> all;
    all.reserve(Size());
    for (uint32_t g = 0; g < Size(); ++g) all.push_back(Candidate(g));
    return all;
}

uint32_t LightGroups::LightOf(LightId light) const { return lights_.LightOf(light); }

LightId LightGroups::SampleWithin(uint32_t group, Float u) const {
    const uint32_t begin = FirstOf(group), end = begin + CountOf(group);
    if (end - begin == 1) return LightId(begin);
    auto it = std::upper_bound(cdf_.begin() + begin, cdf_.begin() + end, u);
    auto index = uint32_t(it - cdf_.begin());
    if (index == end) {  // rounding left the last sum below 1: use the last light with a share
        index = end - 1;
        while (index > begin && share_[index] == 0) --index;
    }
    return LightId(index);
}

size_t LightGroups::Bytes() const {
    return candidates_.capacity() * sizeof(LightCandidate) + first_.capacity() * sizeof(uint32_t) +
           (share_.capacity() + cdf_.capacity()) * sizeof(Float);
}

}  // namespace pbrt
