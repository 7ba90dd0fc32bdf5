#pragma once
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "pbrt/build/built_scene.h"
#include "support/build_text.h"

namespace pbrt::test {

/// A scene, places in it from which lights are chosen, and what every light contributes there.
struct SceneFixture {
    BuiltScene built;
    std::deque<Bsdf> bsdfs;  ///< of some of the queries
    std::vector<LightQuery> queries;
    /// Mean over a fixed set of light points of Le V cos / p, by query and light: the exhaustive twin.
    std::vector<std::vector<double>> contribution;
    bool dark = false;  ///< no light reaches what the camera sees

    const LightTable &Lights() const { return built.scene->Lights(); }
    void Prepare(LightSampler &sampler) const;
    void Prepare(ShadowRayGate &gate) const;
};

std::vector<std::string> SceneFixtureNames();
/// Made once per process.
const SceneFixture &SceneFixtureOf(const std::string &name);

}  // namespace pbrt::test
