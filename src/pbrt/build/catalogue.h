#pragma once
#include <string>
#include <vector>

#include "pbrt/integrators/registry.h"

namespace pbrt {

/// Everything that a scene can name together with its parameters, in the order of a scene file. Light samplers are not
/// among them: their registry lists them. Guided integrators have the parameters of direction sampling as well.
std::vector<FamilyDoc> AllFamilies(const PluginRegistry &registry);

/// Text of `pbrt --list WHAT`: a family; "all": docs/reference/parameters.md; "table": the table of
/// docs/reference/compatibility.md. Throws UserError, which lists the choices, for anything else.
std::string ListWhat(const std::string &what, const PluginRegistry &registry);

}  // namespace pbrt
