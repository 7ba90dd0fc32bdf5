#pragma once
#include <span>

#include "ext/groups/mesh_interior.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {

/// Light samplers that choose a group (MeshGroups) first and then one of its lights (MeshInterior):
/// P(light) = P(group) P(light | group). Derived classes choose the group; a single group needs no choice.
class GroupLightSampler : public LightSampler {
  public:
    std::optional<SampledLight> Sample(const LightQuery &query, Float u) const final;
    Float PMF(const LightQuery &query, LightId light) const final;
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

    /// With two groups or more; none if no group can contribute.
    virtual std::optional<ChosenGroup> SampleGroup(const LightQuery &query, Float u) const = 0;
    virtual Float GroupPMF(const LightQuery &query, uint32_t group) const = 0;

    /// All groups alike; the pmf is 1 / number.
    ChosenGroup SampleUniformly(const LightQuery &query, Float u) const;
    /// By running sums that end at 1.
    static ChosenGroup SampleCdf(std::span<const Float> cdf, const LightQuery &query, Float u);
    static Float CdfPMF(std::span<const Float> cdf, uint32_t group) { return cdf[group] - (group > 0 ? cdf[group - 1] : 0); }

    MeshGroups groups_;
    MeshInterior interior_;
};

}  // namespace ext
