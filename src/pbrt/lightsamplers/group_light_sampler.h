#pragma once
#include <span>

#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace pbrt {

/// Light samplers that choose a group of lights first (LightGroups) and then one of its lights:
/// P(light) = P(group) P(light | group). Derived classes choose the group. Inside the group a light is chosen by its
/// share of the power, unless a derived class overrides ChooseInside.
class GroupLightSampler : public LightSampler {
  public:
    /// The numbers of groups and lights.
    void Report(nlohmann::ordered_json &report) const override;

    const LightGroups &Groups() const { return groups_; }

    /// `pmf`: the probability of the group. `inner`: the uniform number for the choice inside it. `unoccluded` and
    /// `weight`: those of SampledLight, for the group.
    struct ChosenGroup {
        uint32_t group = 0;
        Float pmf = 1, inner = 0;
        Float unoccluded = 0, weight = 0;
    };
    /// Like Weigh, Choose and Probability of LightSampler, for groups. No group is chosen if none can contribute.
    virtual const void *WeighGroups(const LightQuery &, LightMemory &) const { return nullptr; }
    virtual std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const = 0;
    virtual Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const = 0;

  protected:
    /// `alwaysAsked`: ChooseGroup is called even if there is only one group; false: a single group has probability 1.
    explicit GroupLightSampler(const LightGroups &groups, bool alwaysAsked = false) : groups_(groups) {
        SetAlwaysAsked(alwaysAsked);
    }

    /// See the constructor.
    void SetAlwaysAsked(bool alwaysAsked) { isAsked_ = groups_.Size() > (alwaysAsked ? 0 : 1); }

    /// A light of a group and its probability within the group; none if no light there can contribute. `weights`: what
    /// WeighGroups returned; `uPoint`: see LightDistribution::Sample.
    virtual std::optional<SampledLight> ChooseInside(const LightQuery &, const void *weights, uint32_t group, Float u,
                                                     Point2 *uPoint) const {
        (void)weights;
        (void)uPoint;
        const LightId light = groups_.SampleLight(group, u);
        return SampledLight{light, groups_.ShareOf(light)};
    }
    virtual Float ProbabilityInside(const LightQuery &, const void *weights, LightId light) const {
        (void)weights;
        return groups_.ShareOf(light);
    }

    /// Chooses among all groups with equal probabilities.
    ChosenGroup SampleUniformly(const LightQuery &query, Float u) const;
    /// Chooses by the running sums `cdf` of the groups' probabilities, which end at 1.
    static ChosenGroup SampleCdf(std::span<const Float> cdf, const LightQuery &query, Float u);
    static Float CdfPMF(std::span<const Float> cdf, uint32_t group) {
        return cdf[group] - (group > 0 ? cdf[group - 1] : 0);
    }
    /// The number for the choice inside a group, for samplers that have nothing better than a hash of the number u that
    /// chose the group.
    Float InnerNumber(const LightQuery &query, Float u) const {
        if (groups_.Size() == groups_.LightCount()) return 0;  // there is nothing to choose
        return groups_.Size() == 1 ? u : LightGroups::InnerNumber(u, query.p);
    }

    const LightGroups &groups_;

  private:
    const void *Weigh(const LightQuery &query, LightMemory &memory) const final {
        return isAsked_ ? WeighGroups(query, memory) : nullptr;
    }
    std::optional<SampledLight> Choose(const LightQuery &query, const void *weights, Float u,
                                       Point2 *uPoint) const final;
    Float Probability(const LightQuery &query, const void *weights, LightId light) const final;
    bool isAsked_;
};

}  // namespace pbrt
