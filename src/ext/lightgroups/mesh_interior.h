#pragma once
#include <memory>
#include <vector>

#include "ext/lightgroups/emitter_tree.h"
#include "ext/lightgroups/group_importance.h"

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
