#pragma once
#include <memory>
#include <vector>

#include "ext/lightgroups/emitter.h"
#include "ext/lightgroups/emitter_tree.h"
#include "pbrt/lightsamplers/group_light_sampler.h"

namespace ext {

/// P(light | group, query): selects a primitive of an emissive mesh in proportion to its G at the point. Evaluates all
/// primitives up to 32, an EmitterTree above. Back-facing primitives get probability 0; selection by power alone
/// (LightGroups) wastes most samples on curved and closed emitters.
class MeshInterior {
  public:
    /// `byImportance` false: by power, for comparison.
    MeshInterior(const LightGroups &groups, bool byImportance = true);

    /// Samples a light of the group, with its probability within the group; empty if no primitive can contribute.
    std::optional<SampledLight> Sample(uint32_t group, const LightQuery &query, Float u) const;
    Float PMF(const LightQuery &query, LightId light) const;  ///< P(light | its group, query)
    size_t Bytes() const;

  private:
    static constexpr uint32_t kMaxScan = 32;
    struct Inner {
        std::unique_ptr<GroupImportance> scan;
        std::unique_ptr<EmitterTree> tree;
    };
    const LightGroups &groups_;
    bool byImportance_;
    std::vector<Inner> inner_;  ///< per group; both empty for single lights
};

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
