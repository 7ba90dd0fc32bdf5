#pragma once
#include "ext/groups/group_importance.h"
#include "ext/groups/light_tree.h"
#include "ext/groups/mesh_interior.h"
#include "ext/octree/visibility_tree_builder.h"
#include "ext/prepass/prepass.h"

namespace ext {

/// What the prepass found, for VisibilityTreeBuilder.
struct VisibilityRecords {
    std::vector<VisibilityRecord> records;
    std::vector<VisibilityTry> tries;
};

/// Shadow rays a vertex: one to each of `groups` lights up to 64 of them (`wanted` 0), else 8 drawn ones, or as wanted.
size_t TriesPerRecord(size_t groups, int wanted);

/// One shadow ray to lights of every vertex: to all that could contribute if there are no more than `perRecord`, else to
/// that many drawn by G, through `tree` where there is one. Records without any light to look at are left out.
/// The same for any number of threads.
VisibilityRecords TraceVisibility(PrepareContext &context, std::span<const PrepassVertex> vertices, const LightGroups &groups,
                                  const GroupImportance &importance, const MeshInterior &interior, const LightTree *tree,
                                  size_t perRecord);

}  // namespace ext
