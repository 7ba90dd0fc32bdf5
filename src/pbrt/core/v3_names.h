#pragma once
#include <string>
#include <string_view>

namespace pbrt {

/// Replacement of a pbrt-v3 name, as a prefix for the list of valid choices: "it is of pbrt-v3: ...; ". Empty for other
/// names. `what`: the directive whose type it is ("Material"), or "directive", "parameter type", "kind of texture",
/// "parameter".
std::string V3Hint(std::string_view what, std::string_view name);

}  // namespace pbrt
