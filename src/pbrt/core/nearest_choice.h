#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace pbrt {

/// The choice that `given` may be a misspelling of; empty if none is similar.
std::string NearestChoice(std::string_view given, const std::vector<std::string> &choices);

}  // namespace pbrt
