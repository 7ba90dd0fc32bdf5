#pragma once
#include "ext/lightgroups/group_importance.h"
#include "ext/lightgroups/light_tree.h"
#include "ext/lightgroups/mesh_interior.h"
#include "ext/prepass/prepass.h"
#include "ext/visibility/visibility_tree_builder.h"

namespace ext {

/// Shadow rays, for VisibilityTreeBuilder.
struct VisibilityRecords {
    std::vector<VisibilityRecord> records;
    std::vector<ShadowRay> rays;

    template <class Archive>
    void Visit(Archive &archive) {
        archive(records, rays);
    }
    /// Empty, or what is wrong with records that were read. `groups`: of lights; `lights`: the tree over them, or null.
    std::optional<std::string> ValidateFor(size_t groups, const LightTree *lights) const;
};

/// The number of shadow rays from a vertex. `wanted` 0: one to each of up to 64 groups, and 8 to drawn groups if there
/// are more. Else `wanted`, but at most the number of groups.
size_t RaysPerRecord(size_t groups, int wanted);

/// Traces shadow rays from every vertex: to all groups that could contribute if there are at most `perRecord` groups,
/// else to `perRecord` groups drawn in proportion to G, through `tree` unless it is null. A vertex that no group could
/// contribute to gives no record. The result is the same for any number of threads.
VisibilityRecords TraceVisibility(PrepareContext &context, std::span<const PrepassVertex> vertices,
                                  const LightGroups &groups, const GroupImportance &importance,
                                  const MeshInterior &interior, const LightTree *tree, size_t perRecord);

}  // namespace ext
