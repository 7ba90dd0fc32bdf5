#pragma once
#include <string>
#include <vector>

#include "pbrt/core/factory_table.h"

namespace pbrt {

/// Everything that a scene can name together with its parameters, in the order of a scene file. Films and
/// integrators do not declare their parameters yet; light samplers are listed by their registry.
std::vector<FamilyDoc> AllFamilies();

/// Text of `pbrt --list WHAT`: a family; "all" of them as docs/parameters.md; "table" as the table of
/// docs/compatibility.md. Throws UserError with the choices.
std::string ListWhat(const std::string &what);

}  // namespace pbrt
