#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "ext/baselines/neepp/neepp_light_sampler.h"
#include "support/build_text.h"
#include "support/errors.h"
#include "support/light_query.h"
#include "support/scene_text.h"

namespace {

using namespace ext;
using pbrt::test::BuildText, pbrt::test::FloorAndCeiling, pbrt::test::Objects, pbrt::test::PrepareIn,
    pbrt::test::QueryAt, pbrt::test::SceneText;

/// The bounds are [-4, 4]^3, open at the sides; a wall at x = 0 has a gap below y = -2. Rendering space is world space.
std::string Halves(const std::string &lights) {
    return SceneText()
        .Camera("perspective")
        .Film(16, 12)
        .Samples(1)
        .Integrator("path")
        .World(FloorAndCeiling(4, 4, 4).Quad("0 -2 -4  0 4 -4  0 -2 4  0 4 4").Add(lights));
}
const std::string kLights = Objects()
                                .PointLight("-2.5 2.5 0.5", "1 1 1")
                                .PointLight("2.5 2.5 0.5", "1000 1000 1000")
                                .Light("point", "'point3 from' [ 2.5 -3.5 0.5 ]")
                                .Light("distant", "'point3 from' [ -1 0 0 ] 'point3 to' [ 0 0 0 ]");
const std::string kSkyImage =
    "LightSource 'infinite' 'string filename' '" PBRT_SOURCE_DIR "/tests/conformance/suite/scenes/assets/env_sky.exr'";

TEST(Neepp, VisibilityIsTheShareOfFreeSegmentsBetweenTheVoxels) {
    BuiltScene built = BuildText(Halves(kLights + kSkyImage));
    NeeppLightSampler map(built.scene->Lights(), {.voxels = 8, .samples = 255});
    PrepareIn(built, map);
    ASSERT_GT(map.Targets().Size(), 4u + 8u);
    Rng rng(5);
    double worst = 0;
    int partly = 0;
    for (const Point3 &p : {Point3(-2.5f, 2.5f, 0.5f), Point3(-0.5f, -2.5f, 0.5f), Point3(-3.5f, -3.5f, 1.5f),
                            Point3(1.5f, -1.5f, 3.5f)}) {
        uint32_t voxel = map.Grid().Index(p);
        std::span<const uint8_t> row = map.Row(voxel);
        for (uint32_t t = 0; t < row.size(); ++t) {
            // The slow twin, with its own random numbers.
            const LightTargets::Target &target = map.Targets()[t];
            const int n = 2000;
            int open = 0;
            for (int i = 0; i < n; ++i) {
                Ray ray;
                ray.o = map.Grid().PointIn(voxel, Vector3{rng.Uniform(), rng.Uniform(), rng.Uniform()});
                if (target.kind == LightTargets::Kind::Voxel) {
                    const Vector3 u{rng.Uniform(), rng.Uniform(), rng.Uniform()};
                    ray.d = map.Grid().PointIn(target.index, u) - ray.o;
                    ray.tMax = 1;
                } else {
                    ray.d = target.kind == LightTargets::Kind::Direction
                                ? Vector3(-1, 0, 0)
                                : LightTargets::DirectionIn(target.index, rng.Uniform2());
                }
                open += !built.scene->Occluded(ray);
            }
            double expected = double(open) / n, found = row[t] / 255.0;
            double sigma = std::sqrt(expected * (1 - expected) * (1 / 255.0 + 1.0 / n));
            double z = std::abs(found - expected) / (sigma + 0.004);
            worst = std::max(worst, z);
            partly += expected > 0.1 && expected < 0.9;
        }
    }
    EXPECT_LT(worst, 5);
    EXPECT_GT(partly, 20) << "too few voxels are partly visible for this test to mean anything";
}

TEST(Neepp, ProbabilityIsTheVisibilityWithAFloorWhateverThePower) {
    BuiltScene built = BuildText(Halves(kLights));
    NeeppLightSampler sampler(built.scene->Lights(), {.voxels = 8, .samples = 64});
    PrepareIn(built, sampler);
    // At a point high up on the left, the left light is seen; the right one and the low one behind the wall's edge are
    // not.
    LightQuery left = QueryAt({-3.5f, 3.5f, 0.5f});
    std::span<const uint8_t> row = sampler.Row(sampler.Grid().Index(left.p));
    Float v[4], sum = 0;
    for (uint32_t g = 0; g < 4; ++g) {
        v[g] = sampler.GroupVisibility(row, g);
        sum += std::max(v[g], 0.02f);
    }
    EXPECT_EQ(v[0], 1.f);
    EXPECT_EQ(v[1], 0.f);
    EXPECT_EQ(v[2], 0.f);
    EXPECT_EQ(v[3], 1.f);  // the sun shines in through the open side
    for (uint32_t g = 0; g < 4; ++g) EXPECT_NEAR(sampler.PMF(left, LightId(g)), std::max(v[g], 0.02f) / sum, 1e-6f);
    // In the gap all point lights and the sun are seen, so all have equal probabilities, although one light is 1000
    // times as strong.
    LightQuery gap = QueryAt({0.5f, -3.5f, 0.5f});
    EXPECT_NEAR(sampler.PMF(gap, LightId(2u)), sampler.PMF(gap, LightId(3u)), 0.02f);
    // On the right only the right lights are seen; the sun is seen only below the wall.
    LightQuery right = QueryAt({3.5f, 3.5f, 0.5f});
    EXPECT_GT(sampler.PMF(right, LightId(1u)), 8 * sampler.PMF(right, LightId(0u)));
    EXPECT_NEAR(sampler.PMF(right, LightId(3u)), sampler.PMF(right, LightId(0u)), 1e-6f);
}

TEST(Neepp, AnAreaLightCountsByItsVisibleFraction) {
    // A strip of light crosses the wall; its right third is not seen from the left.
    BuiltScene built = BuildText(Halves(Objects()
                                            .Add("AreaLightSource 'diffuse'")
                                            .Triangles("-2 3.5 0.1  1 3.5 0.1  1 3.5 0.9  -2 3.5 0.9")
                                            .Triangles("-3.9 3.5 0.1  -3.1 3.5 0.1  -3.1 3.5 0.9  -3.9 3.5 0.9")));
    NeeppLightSampler sampler(built.scene->Lights(), {.voxels = 8, .samples = 255});
    PrepareIn(built, sampler);
    std::span<const uint8_t> row = sampler.Row(sampler.Grid().Index({-3.5f, -0.5f, 0.5f}));
    EXPECT_NEAR(sampler.GroupVisibility(row, 0) / sampler.GroupVisibility(row, 1), 2.f / 3, 0.1f);
}

TEST(Neepp, AnOccludedLightKeepsTheFloor) {
    BuiltScene built = BuildText(Halves(kLights));
    NeeppLightSampler sampler(built.scene->Lights(), {.voxels = 8, .samples = 16, .floor = 0.25f});
    PrepareIn(built, sampler);
    LightQuery left = QueryAt({-3.5f, 3.5f, 0.5f});
    EXPECT_NEAR(sampler.PMF(left, LightId(1u)) / sampler.PMF(left, LightId(0u)), 0.25f, 1e-5f);
}

TEST(Neepp, OtherSeedsTestOtherSegments) {
    BuiltScene built = BuildText(Halves(kLights));
    NeeppLightSampler a(built.scene->Lights(), {}), b(built.scene->Lights(), {}), c(built.scene->Lights(), {});
    PrepareIn(built, a);
    PrepareIn(built, b);
    built.seed = 1;
    PrepareIn(built, c);
    int different = 0;
    for (uint32_t v = 0; v < a.Grid().Size(); v += 7) {
        LightQuery q = QueryAt(a.Grid().PointIn(v, Vector3(0.5f)));
        EXPECT_EQ(a.PMF(q, LightId(0u)), b.PMF(q, LightId(0u)));
        different += a.PMF(q, LightId(0u)) != c.PMF(q, LightId(0u));
    }
    EXPECT_GT(different, 5);
}

TEST(Neepp, ReportAndInspectListWhatIsStored) {
    BuiltScene built = BuildText(Halves(kLights));
    NeeppLightSampler sampler(built.scene->Lights(), {.voxels = 8, .samples = 16});
    PrepareIn(built, sampler);
    sampler.Sample(QueryAt({-3.5f, 3.5f, 0.5f}), 0.5f);
    nlohmann::ordered_json report;
    sampler.Report(report);
    EXPECT_EQ(report["voxels"], 512);
    EXPECT_EQ(report["voxelsFilled"], 1);
    EXPECT_EQ(report["targets"], 4);
    EXPECT_EQ(report["visibilityRays"], 4 * 16);
    std::vector<InspectedValue> values;
    sampler.Inspect(QueryAt({-3.5f, 3.5f, 0.5f}), values);
    ASSERT_EQ(values.size(), 3u);
    EXPECT_EQ(values[1].value, 2);
    EXPECT_NEAR(values[2].value, 0.5, 1e-6);
    test::ExpectWords(sampler.DescribeStructure(), {"8 x 8 x 8 voxels"});
}

}  // namespace
