#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "pbrt/core/float.h"
#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace pbrt {

/// Light samplers that select a group (LightGroups), then one of its lights: P(light) = P(group) P(light | group).
/// Derived classes select the group. Within it, lights are selected by power unless ChooseInside is overridden.
class GroupLightSampler : public LightSampler {
  public:
    void Report(nlohmann::ordered_json &report) const override;

    const LightGroups &Groups() const { return groups_; }

    /// `pmf`: probability of the group. `inner`: uniform number for the selection within it. `unoccluded` and `weight`:
    /// as SampledLight, for the group.
    struct ChosenGroup {
        uint32_t group = 0;
        Float pmf = 1, inner = 0;
        Float unoccluded = 0, weight = 0;
    };
    /// LightSampler's Weigh, Choose and Probability for groups. No group is selected if none can contribute.
    virtual const void *WeighGroups(const LightQuery &, LightMemory &) const { return nullptr; }
    virtual std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const = 0;
    virtual Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const = 0;

  protected:
    /// `alwaysChooses`: call ChooseGroup even for a single group; false: a single group has probability 1.
    explicit GroupLightSampler(const LightGroups &groups, bool alwaysChooses = false) : groups_(groups) {
        SetAlwaysChooses(alwaysChooses);
    }

    void SetAlwaysChooses(bool alwaysChooses) { choosesGroup_ = groups_.Size() > (alwaysChooses ? 0 : 1); }

    /// Samples a light of a group, with its probability within the group; empty if no light there can contribute.
    /// `weights`: result of WeighGroups; `uPoint`: see LightDistribution::Sample.
    virtual std::optional<SampledLight> ChooseInside(const LightQuery &, const void * /*weights*/, uint32_t group,
                                                     Float u, Point2 * /*uPoint*/) const {
        const LightId light = groups_.SampleLight(group, u);
        return SampledLight{light, groups_.ShareOf(light)};
    }
    virtual Float ProbabilityInside(const LightQuery &, const void * /*weights*/, LightId light) const {
        return groups_.ShareOf(light);
    }

    ChosenGroup SampleUniformly(const LightQuery &query, Float u) const;
    /// Selects by the CDF of the groups.
    static ChosenGroup SampleCdf(std::span<const Float> cdf, const LightQuery &query, Float u);
    static Float CdfPMF(std::span<const Float> cdf, uint32_t group) {
        return cdf[group] - (group > 0 ? cdf[group - 1] : 0);
    }
    /// Number for selection within a group, as a hash of the number u that selected the group.
    Float InnerNumber(const LightQuery &query, Float u) const {
        if (groups_.Size() == groups_.LightCount()) return 0;
        return groups_.Size() == 1 ? u : LightGroups::InnerNumber(u, query.p);
    }

    const LightGroups &groups_;

  private:
    const void *Weigh(const LightQuery &query, LightMemory &memory) const final {
        return choosesGroup_ ? WeighGroups(query, memory) : nullptr;
    }
    std::optional<SampledLight> Choose(const LightQuery &query, const void *weights, Float u,
                                       Point2 *uPoint) const final;
    Float Probability(const LightQuery &query, const void *weights, LightId light) const final;
    bool choosesGroup_;
};

/// First selection of samplers with light bounds, as in stock pbrt-v4: every infinite light, and all bounded lights
/// together, have equal probability.
class InfiniteShare {
  public:
    InfiniteShare() = default;
    InfiniteShare(const LightGroups &groups, bool anyBounded) : isInfinite_(groups.Size()), anyBounded_(anyBounded) {
        for (uint32_t i = 0; i < groups.Size(); ++i) {
            isInfinite_[i] = groups.Candidate(i).infinite;
            if (isInfinite_[i]) infinite_.push_back(i);
        }
        size_t shares = infinite_.size() + (anyBounded ? 1 : 0);
        share_ = shares > 0 ? 1 / Float(shares) : 0;
        boundedFrom_ = double(infinite_.size()) / double(std::max<size_t>(shares, 1));
    }
    /// Probability of each infinite light, and of all bounded ones together.
    Float Pmf() const { return share_; }
    bool Holds(uint32_t group) const { return isInfinite_[group]; }
    /// Returns true for the bounded lights, remapping `u` to a fresh number; else sets `chosen`. There must be a light.
    bool ChooseBounded(double &u, uint32_t *chosen) const {
        if (anyBounded_ && u >= boundedFrom_) {
            u = (u - boundedFrom_) / (1 - boundedFrom_);
            return true;
        }
        double scaled = u / boundedFrom_ * double(infinite_.size());
        *chosen = infinite_[std::min(size_t(scaled), infinite_.size() - 1)];
        return false;
    }
    size_t Bytes() const { return infinite_.capacity() * sizeof(uint32_t); }

  private:
    std::vector<uint32_t> infinite_;
    std::vector<bool> isInfinite_;  ///< by group
    bool anyBounded_ = false;
    Float share_ = 0;
    double boundedFrom_ = 0;
};

}  // namespace pbrt
