#pragma once
#include <memory>
#include <vector>

#include "ext/groups/emitter_tree.h"
#include "ext/groups/group_importance.h"

namespace ext {

/// P(light | group, query): which primitive of an emissive mesh, once the mesh is chosen. By importance at the point: all
/// primitives looked at up to 32 of them, through a tree over them above that. Primitives that face away get nothing, near
/// ones more; by power alone (LightGroups) curved and closed emitters waste most samples.
class MeshInterior {
  public:
    /// `byImportance` false: by power, for comparison.
    MeshInterior(const LightGroups &groups, bool byImportance = true);

    /// A light of the group and its probability within the group; none if no primitive can contribute.
    std::optional<SampledLight> Sample(uint32_t group, const LightQuery &query, Float u) const;
    /// P(light | its group, query).
    Float PMF(const LightQuery &query, LightId light) const;
    size_t Bytes() const;

  private:
    static constexpr uint32_t kLargestScan = 32;
    struct Inner {
        std::unique_ptr<GroupImportance> scan;
        std::unique_ptr<EmitterTree> tree;
    };
    const LightGroups &groups_;
    bool byImportance_;
    std::vector<Inner> inner_;  ///< per group; both empty for single lights
};

}  // namespace ext
