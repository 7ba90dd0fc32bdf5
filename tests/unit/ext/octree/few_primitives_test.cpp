#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "ext/octree/visibility_octree_light_sampler.h"
#include "support/build_text.h"
#include "support/scene_text.h"

namespace ext {
namespace {

/// The groups that octree chooses from in a scene with `points` point lights and a lamp of `triangles` triangles.
size_t Groups(int points, int triangles, bool meshLights) {
    test::Objects world;
    for (int i = 0; i < points; ++i) world.Light("point");
    std::string corners, indices;
    for (int i = 0; i < triangles; ++i) corners += fmt::format("{} 0 5 {} 1 5 ", i, i);
    corners += fmt::format("{} 0 5", triangles);
    for (int i = 0; i < triangles; ++i) indices += fmt::format(" {} {} {}", 2 * i, 2 * i + 1, 2 * i + 2);
    world.Add("AreaLightSource 'diffuse'").Triangles(corners, indices);
    const BuiltScene built = test::BuildText(test::SceneText().Camera("perspective").World(world));
    const VisibilityOctreeLightSampler octree(built.scene->Lights(), {.meshlights = meshLights});
    nlohmann::ordered_json report;
    octree.Report(report);
    return report["groups"];
}

TEST(FewPrimitives, AreLightsOfTheirOwn) {
    EXPECT_EQ(Groups(2, 2, true), 4u);
    EXPECT_EQ(Groups(2, 6, true), 8u);
    EXPECT_EQ(Groups(2, 7, true), 3u);  // nine primitives do not fit into one packet
    EXPECT_EQ(Groups(0, 2, true), 1u);  // nothing to choose but the primitive
    EXPECT_EQ(Groups(2, 7, false), 9u);
}

}  // namespace
}  // namespace ext
