#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pbrt/lightsamplers/registry.h"
#include "pbrt/shapes/shape.h"

namespace pbrt::test {

/// Lights, and places from which they are chosen. Made of real lights: what they contribute is asked of them.
struct ContractFixture {
    std::vector<std::unique_ptr<Shape>> shapes;  ///< of the area lights; outlive them
    std::unique_ptr<LightTable> owned;           ///< the lights, unless a Scene owns them
    const LightTable *lights = nullptr;
    std::vector<LightQuery> queries;
    /// For fixtures that have a Scene: calls sampler.Prepare with it. What the function needs is kept alive by it.
    /// Empty: samplers are used as made.
    std::function<void(LightSampler &)> prepare;
};

struct FixtureEntry {
    std::string name;
    std::function<std::unique_ptr<ContractFixture>()> make;
};

/// none, one, many, infinite only, a mesh of 10,000 triangles, zero power, coincident, scaled down and up, ...
const std::vector<FixtureEntry> &ContractFixtures();

}  // namespace pbrt::test
