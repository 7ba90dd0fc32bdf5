#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace pbrt::lab {

/// cpu, threads, memoryGB, os of this machine; null where unknown.
nlohmann::ordered_json DescribeMachine();
/// The present time in UTC, as 2026-11-21T03:00:00Z.
std::string DateText();

}  // namespace pbrt::lab
