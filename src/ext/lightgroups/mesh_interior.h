#pragma once
#include <memory>
#include <vector>

#include "ext/lightgroups/emitter_tree.h"
#include "ext/lightgroups/group_importance.h"

namespace ext {

/// P(light | group, query): chooses a primitive of an emissive mesh, once the mesh is chosen. The choice is by the
/// importance G at the point: G of every primitive is evaluated for up to 32 primitives, an EmitterTree is used for
/// more. Primitives that face away get nothing, near ones more; a choice by power alone (LightGroups) wastes most
/// samples on curved and closed emitters.
class MeshInterior {
  public:
    /// `byImportance` false: the choice is by power, for comparison.
    MeshInterior(const LightGroups &groups, bool byImportance = true);

    /// A light of the group and its probability within the group; none if no primitive can contribute.
    std::optional<SampledLight> Sample(uint32_t group, const LightQuery &query, Float u) const;
    /// P(light | its group, query).
    Float PMF(const LightQuery &query, LightId light) const;
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

}  // namespace ext
