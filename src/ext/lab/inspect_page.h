#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace pbrt::lab {

/// The HTML page for the pictures in the same folder, made from the contents of inspect.json: pictures with captions,
/// sentences about layers that are the same everywhere, the lights, the structure.
std::string InspectPage(const nlohmann::ordered_json &inspection, const std::string &structure);

}  // namespace pbrt::lab
