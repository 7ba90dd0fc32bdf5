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
    /// The mean of Le V cos / p over a fixed set of light points, indexed by query and light: the result of an
    /// exhaustive search.
    std::vector<std::vector<double>> contribution;
    bool dark = false;  ///< no light reaches what the camera sees
    int points = 32;    ///< on each light
    /// The contribution of any id, also of a part of a sky.
    double ContributionOf(size_t query, LightId id) const;

    double Search(size_t query, LightId id) const;  ///< the same, always searched for

    const LightTable &Lights() const { return built.scene->Lights(); }
};

/// The sampler of `label`, after Prepare. A label is name[:key=value,...]; "+meshlights" after it makes every emissive
/// mesh one light.
std::unique_ptr<LightSampler> MakePreparedSampler(const std::string &label, const SceneFixture &fixture,
                                                  const PluginRegistry &registry = AllSamplers());

/// `count` vertices of camera paths, taken in turn from the first `depth` of a path, and as many points anywhere in the
/// bounds; half of them also as places in a medium. Every `bsdfEvery`-th vertex has a BSDF, which `bsdfs` owns.
std::vector<LightQuery> Places(const BuiltScene &built, int count, int depth, int bsdfEvery, std::deque<Bsdf> &bsdfs);
/// What next-event estimation finds with this light point: L V cos / p, or 0 if the query has a BSDF and that is 0.
/// `wi`, if not null, receives the direction of the point.
double Contribution(const Scene &scene, const LightQuery &query, const LightComponent &light, const Point2 &u,
                    Vector3 *wi = nullptr, bool allowIncompletePdfs = true);

std::vector<std::string> SceneFixtureNames();
/// Made once per process.
const SceneFixture &SceneFixtureOf(const std::string &name);

}  // namespace pbrt::test
