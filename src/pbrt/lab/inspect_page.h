#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace pbrt::lab {

/// One page for people over the pictures beside it, from what inspect.json holds: pictures with captions, in words what
/// is the same everywhere, the lights, the structure.
std::string InspectPage(const nlohmann::ordered_json &inspection, const std::string &structure);

}  // namespace pbrt::lab
