#pragma once
#include <string>
#include <vector>

#include "pbrt/core/factory_table.h"

namespace pbrt {

/// Everything that a scene can name together with its parameters, in the order of a scene file. Light samplers are not
/// among them: their registry lists them.
std::vector<FamilyDoc> AllFamilies();

/// Text of `pbrt --list WHAT`: a family; "all": docs/reference/parameters.md; "table": the table of
/// docs/reference/compatibility.md. Throws UserError, which lists the choices, for anything else.
std::string ListWhat(const std::string &what);

}  // namespace pbrt
