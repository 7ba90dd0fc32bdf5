#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pbrt/integrators/registry.h"
#include "pbrt/shapes/shape.h"

namespace pbrt::test {

/// Lights, and places from which they are chosen. The lights are real ones, so what they contribute is computed by
/// themselves.
struct ContractFixture {
    std::vector<std::unique_ptr<Shape>> shapes;  ///< of the area lights, which refer to them
    std::unique_ptr<LightTable> owned;           ///< the lights, unless a Scene owns them
    const LightTable *lights = nullptr;
    std::vector<LightQuery> queries;
    /// For fixtures that have a Scene: calls sampler.Prepare with it. The function owns what it needs. Empty: samplers
    /// are used without Prepare.
    std::function<void(LightSampler &)> prepare;
};

struct FixtureEntry {
    std::string name;
    std::function<std::unique_ptr<ContractFixture>()> make;
};

/// All fixtures: no light, one, many, infinite ones only, a mesh of 10,000 triangles, zero power, coincident, scaled
/// down and up, ...
const std::vector<FixtureEntry> &ContractFixtures();

}  // namespace pbrt::test
