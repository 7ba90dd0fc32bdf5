#pragma once
#include <string>
#include <vector>

#include "pbrt/integrators/registry.h"

namespace pbrt {

/// All scene entities with their parameters, in scene file order. Excludes light samplers, listed by their registry.
/// Guided integrators include the parameters of direction sampling.
std::vector<FamilyDoc> AllFamilies(const PluginRegistry &registry);

/// Text of `pbrt --list WHAT`: a family; "all": docs/reference/parameters.md; "table": the table of
/// docs/reference/compatibility.md. Throws UserError with the choices for anything else.
std::string ListWhat(const std::string &what, const PluginRegistry &registry);

}  // namespace pbrt
