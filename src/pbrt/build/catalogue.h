#pragma once
#include <string>

#include "pbrt/integrators/registry.h"

namespace pbrt {

/// Text of `pbrt --list WHAT`: a family; "all": docs/reference/parameters.md; "table": the table of
/// docs/reference/compatibility.md. Throws UserError with the choices for anything else.
std::string ListWhat(const std::string &what, const PluginRegistry &registry);

}  // namespace pbrt
