#pragma once
#include <span>

#include "ext/groups/mesh_interior.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {

/// Light samplers that choose a group (MeshGroups) first and then one of its lights (MeshInterior):
/// P(light) = P(group) P(light | group). Derived classes choose the group; a single group needs no choice.
class GroupLightSampler : public LightSampler {
  public:
    /// The numbers of groups and lights.
    void Report(nlohmann::ordered_json &report) const override;

    const MeshGroups &Groups() const { return groups_; }

  protected:
    /// `pmf`: of the group. `inner`: the uniform number for the choice inside. `unoccluded`, `weight`: of the group, as in SampledLight.
    struct ChosenGroup {
        uint32_t group = 0;
        Float pmf = 1, inner = 0;
        Float unoccluded = 0, weight = 0;
    };
    GroupLightSampler(const LightTable &lights, bool meshlights, bool interiorByImportance)
        : groups_(lights, meshlights), interior_(lights, groups_, interiorByImportance) {}

    /// As LightSampler's Weigh, Choose and Probability, for groups; only asked where there are two or more. No group is
    /// chosen if none can contribute.
    virtual const void *WeighGroups(const LightQuery &query, LightMemory &memory) const = 0;
    virtual std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const = 0;
    virtual Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const = 0;

    /// All groups alike; the pmf is 1 / number.
    ChosenGroup SampleUniformly(const LightQuery &query, Float u) const;
    /// By running sums that end at 1.
    static ChosenGroup SampleCdf(std::span<const Float> cdf, const LightQuery &query, Float u);
    static Float CdfPMF(std::span<const Float> cdf, uint32_t group) { return cdf[group] - (group > 0 ? cdf[group - 1] : 0); }

    MeshGroups groups_;
    MeshInterior interior_;

  private:
    const void *Weigh(const LightQuery &query, LightMemory &memory) const final {
        return groups_.Size() > 1 ? WeighGroups(query, memory) : nullptr;
    }
    std::optional<SampledLight> Choose(const LightQuery &query, const void *weights, Float u) const final;
    Float Probability(const LightQuery &query, const void *weights, LightId light) const final;
};

}  // namespace ext
