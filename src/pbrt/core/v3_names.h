#pragma once
#include <string>
#include <string_view>

namespace pbrt {

/// What pbrt-v4 has in place of a name of pbrt-v3, to be put before the valid choices in a message: "it is of pbrt-v3:
/// ...; ". Empty for all other names. `what`: the directive whose type it is ("Material"), or "directive", "parameter
/// type", "kind of texture", "parameter".
std::string V3Hint(std::string_view what, std::string_view name);

}  // namespace pbrt
