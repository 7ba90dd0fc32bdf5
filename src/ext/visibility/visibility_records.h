#pragma once
#include "ext/lightgroups/emitter.h"
#include "ext/lightgroups/light_tree.h"
#include "ext/lightgroups/mesh_interior.h"
#include "ext/prepass/prepass.h"
#include "ext/visibility/visibility_tree_builder.h"

namespace ext {

struct VisibilityRecords {
    std::vector<VisibilityRecord> records;
    std::vector<ShadowRay> rays;

    void Visit(auto &archive) { archive(records, rays); }
    /// Empty if the loaded records are valid, else the error. `groups`: of lights; `lights`: light tree or null.
    std::optional<std::string> ValidateFor(size_t groups, const LightTree *lights) const;
};

/// Number of shadow rays per vertex. `wanted` 0: one to each group up to 64 groups, else 8 to drawn groups. Otherwise
/// `wanted`, at most the number of groups.
size_t RaysPerRecord(size_t groups, int wanted);

/// Traces shadow rays from every vertex: to all groups that could contribute, if there are at most `perRecord` groups.
/// Otherwise to `perRecord` groups, most of them drawn in proportion to G, through `tree` unless null. Vertices that no
/// group could contribute to give no record. Deterministic for any number of threads.
VisibilityRecords TraceVisibility(PrepareContext &context, std::span<const PrepassVertex> vertices,
                                  const LightGroups &groups, const GroupImportance &importance,
                                  const MeshInterior &interior, const LightTree *tree, size_t perRecord);

}  // namespace ext
