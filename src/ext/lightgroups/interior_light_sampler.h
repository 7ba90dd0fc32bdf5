#pragma once
#include "ext/lightgroups/mesh_interior.h"
#include "pbrt/lightsamplers/group_light_sampler.h"

namespace ext {

/// Group light samplers that select within a group by importance at the point (MeshInterior).
class InteriorLightSampler : public GroupLightSampler {
  protected:
    InteriorLightSampler(const LightTable &lights, bool meshlights, bool interiorByImportance)
        : GroupLightSampler(meshlights ? lights.ByLight() : lights.ByComponent()),
          interior_(groups_, interiorByImportance) {}

    std::optional<SampledLight> ChooseInside(const LightQuery &query, const void *, uint32_t group, Float u,
                                             Point2 *) const override {
        return interior_.Sample(group, query, u);
    }
    Float ProbabilityInside(const LightQuery &query, const void *, LightId light) const override {
        return interior_.PMF(query, light);
    }

    MeshInterior interior_;
};

}  // namespace ext
