#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "ext/baselines/neepp/neepp_light_sampler.h"
#include "support/build_text.h"
#include "support/folder_test.h"
#include "support/scene_text.h"

namespace {

using namespace ext;
using pbrt::test::BuildText, pbrt::test::FloorAndCeiling, pbrt::test::Objects, pbrt::test::SceneText;
using Kind = LightTargets::Kind;

struct Made {
    BuiltScene built;
    VoxelGrid grid;
    LightTargets targets;
};
/// The bounds are [-4, 4]^3, and rendering space is world space.
Made Make(const std::string &lights, bool grouped = true) {
    Made m;
    m.built = BuildText(SceneText()
                            .Camera("perspective")
                            .Film(16, 12)
                            .Samples(1)
                            .Integrator("path")
                            .World(FloorAndCeiling(4, 4, 4).Add(lights)));
    m.grid = VoxelGrid(m.built.scene->Bounds(), 8);
    const LightTable &table = m.built.scene->Lights();
    m.targets = LightTargets::Of(*m.built.scene, m.grid, grouped ? table.ByLight() : table.ByComponent());
    return m;
}

/// True if the light's group covers the voxel or cell of the sky.
bool Covers(const Made &m, LightId light, uint32_t index) {
    const auto shares = m.targets.SharesOf(m.built.scene->Lights().ByLight().GroupOf(light));
    return std::any_of(shares.begin(), shares.end(),
                       [&](const LightTargets::Share &s) { return m.targets[s.target].index == index; });
}

TEST(LightTargets, LightsInOneVoxelShareATarget) {
    Made m = Make(Objects()
                      .Light("point", "'point3 from' [ 1.2 1.2 1.2 ]")
                      .Light("spot", "'point3 from' [ 1.7 1.6 1.5 ] 'point3 to' [ 0 0 0 ]")
                      .Light("point", "'point3 from' [ -1.2 1.2 1.2 ]")
                      .Light("point", "'point3 from' [ 100 0.5 0.5 ]")
                      .Light("point", "'point3 from' [ 0.5 0.5 0.5 ] 'float scale' 0"));
    ASSERT_EQ(m.targets.Size(), 3u);
    EXPECT_EQ(m.targets.SharesOf(0)[0].target, m.targets.SharesOf(1)[0].target);
    EXPECT_NE(m.targets.SharesOf(0)[0].target, m.targets.SharesOf(2)[0].target);
    EXPECT_EQ(m.targets[m.targets.SharesOf(0)[0].target].index, m.grid.Index({1.2f, 1.2f, 1.2f}));
    EXPECT_EQ(m.targets[m.targets.SharesOf(3)[0].target].index, m.grid.Index({3.9f, 0.5f, 0.5f}));
    EXPECT_TRUE(m.targets.SharesOf(4).empty());  // no power
    for (uint32_t g = 0; g < 4; ++g) EXPECT_EQ(m.targets.SharesOf(g)[0].weight, 1.f);
}

TEST(LightTargets, AnAreaLightCoversVoxelsByItsArea) {
    // The light covers x in [-1.5, 0.9] and z in [0.25, 0.75]; voxels have side 1. So they hold 0.5, 1 and 0.9 of its
    // length 2.4.
    Made m = Make(Objects()
                      .Add("AreaLightSource 'diffuse'")
                      .Triangles("-1.5 0.5 0.25  0.9 0.5 0.25  0.9 0.5 0.75  -1.5 0.5 0.75"));
    ASSERT_EQ(m.built.scene->Lights().ByLight().Size(), 1u);
    std::map<uint32_t, Float> weight;
    Float sum = 0;
    for (const LightTargets::Share &s : m.targets.SharesOf(0)) {
        weight[m.targets[s.target].index] = s.weight;
        sum += s.weight;
    }
    ASSERT_EQ(weight.size(), 3u);
    EXPECT_NEAR(sum, 1, 1e-5f);
    EXPECT_NEAR(weight[m.grid.Index({-1.2f, 0.5f, 0.5f})], 0.5f / 2.4f, 0.03f);
    EXPECT_NEAR(weight[m.grid.Index({-0.5f, 0.5f, 0.5f})], 1 / 2.4f, 0.03f);
    EXPECT_NEAR(weight[m.grid.Index({0.5f, 0.5f, 0.5f})], 0.9f / 2.4f, 0.03f);
}

TEST(LightTargets, EveryPointOfALargeLightIsExpected) {
    Made m =
        Make(Objects().Add("AreaLightSource 'diffuse'").Sphere(3).Triangles("-4 3.5 -4  4 3.5 -4  4 3.5 4  -4 3.5 4"));
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    Rng rng(2);
    int missed = 0, tested = 0;
    for (int i = 0; i < 3000; ++i) {
        const LightSampleContext from{.p = Vector3{rng.Uniform(), rng.Uniform(), rng.Uniform()} * Float(8) - Float(4)};
        LightId light(rng.UniformInt(3));
        auto s = m.built.scene->Lights()[light].SampleLi(from, rng.Uniform2(), lambda, true);
        if (!s) continue;
        ++tested;
        missed += !Covers(m, light, m.grid.Index(s->pLight));
    }
    EXPECT_GT(tested, 500);
    EXPECT_LT(missed, tested / 200);
}

TEST(LightTargets, ADistantLightIsADirection) {
    Made m = Make(R"(LightSource "distant" "point3 from" [ 0 2 2 ] "point3 to" [ 0 0 0 ])");
    ASSERT_EQ(m.targets.Size(), 1u);
    EXPECT_EQ(m.targets[0].kind, Kind::Direction);
    EXPECT_NEAR(Distance(m.targets[0].direction, Normalize(Vector3(0, 1, 1))), 0, 1e-5f);
}

const std::string kSky = std::string("LightSource \"infinite\" \"string filename\" \"") + PBRT_SOURCE_DIR +
                         "/tests/conformance/suite/scenes/assets/env_sky.exr\"";

TEST(LightTargets, TheEnvironmentIsInEqualCellsThatCoverItsSamples) {
    Rng rng(6);
    for (int i = 0; i < 64 * 50; ++i) {
        auto cell = uint32_t(i % 64);
        Point2 u(0.01f + 0.98f * rng.Uniform(), 0.01f + 0.98f * rng.Uniform());
        EXPECT_EQ(LightTargets::EnvironmentCellOf(LightTargets::DirectionIn(cell, u)), cell);
    }
    // The weight of a cell is the share of the light's samples that go there.
    Made m = Make(kSky);
    EXPECT_GT(m.targets.Size(), 8u);
    EXPECT_LE(m.targets.Size(), 64u);
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    std::vector<double> value(64);
    double all = 0, unexpected = 0;
    for (int i = 0; i < 20000; ++i) {
        auto s = m.built.scene->Lights()[LightId(0u)].SampleLi({.p = {1, 0, 1}}, rng.Uniform2(), lambda, true);
        ASSERT_TRUE(s);
        const uint32_t cell = LightTargets::EnvironmentCellOf(s->wi);
        value[cell] += 1;
        all += 1;
        if (!Covers(m, LightId(0u), cell)) unexpected += 1;
    }
    EXPECT_LT(unexpected, 0.01 * all);
    double sum = 0;
    for (const LightTargets::Share &s : m.targets.SharesOf(0)) {
        EXPECT_EQ(m.targets[s.target].kind, Kind::EnvironmentCell);
        EXPECT_NEAR(double(s.weight), value[m.targets[s.target].index] / all, 0.01);
        sum += double(s.weight);
    }
    EXPECT_NEAR(sum, 1, 1e-5);
}

TEST(LightTargets, AnEnvironmentOfOneColourIsNotSampledAndHasNone) {
    Made m = Make(R"(LightSource "infinite")");
    EXPECT_EQ(m.targets.Size(), 0u);
}

TEST(LightTargets, UngroupedLightsStandWhereTheirOwnShapeIs) {
    // The second sphere and the second triangle of the mesh must not be taken for the first.
    Made m = Make(Objects()
                      .Add("AreaLightSource 'diffuse'")
                      .Triangles("-2.6 0.5 0.5  -2.5 0.5 0.5  -2.5 0.6 0.5  2.4 0.5 0.5  2.5 0.5 0.5  2.5 0.6 0.5",
                                 "0 1 2  3 4 5")
                      .Attribute("Translate 0.5 2.5 0.5", Objects().Sphere(0.1))
                      .Attribute("Translate 0.5 -2.5 0.5", Objects().Sphere(0.1)),
                  false);
    ASSERT_EQ(m.built.scene->Lights().ByComponent().Size(), 4u);
    ASSERT_EQ(m.targets.Size(), 4u);
    const Point3 places[] = {{-2.55f, 0.55f, 0.5f}, {2.45f, 0.55f, 0.5f}, {0.5f, 2.5f, 0.5f}, {0.5f, -2.5f, 0.5f}};
    for (uint32_t g = 0; g < 4; ++g)
        EXPECT_EQ(m.targets[m.targets.SharesOf(g)[0].target].index, m.grid.Index(places[g]));
}

class LightTargetsOfFile : public pbrt::test::FolderTest {};

TEST_F(LightTargetsOfFile, ADirectiveThatMakesTwoShapesHasItsLightsOnBoth) {
    // A PLY file of a triangle and a quad becomes a triangle mesh and a bilinear one, both with primitives from 0.
    const std::string file =
        Write("two.ply",
              "ply\nformat ascii 1.0\nelement vertex 7\nproperty float x\nproperty float y\nproperty float z\n"
              "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
              "-2.6 0.5 0.5\n-2.5 0.5 0.5\n-2.5 0.6 0.5\n"
              "2.4 0.5 0.5\n2.5 0.5 0.5\n2.5 0.6 0.5\n2.4 0.6 0.5\n3 0 1 2\n4 3 4 5 6\n");
    Made m = Make("AreaLightSource 'diffuse' Shape 'plymesh' 'string filename' '" + file + "'");
    ASSERT_EQ(m.built.scene->Lights().Size(), 2u);
    ASSERT_EQ(m.built.scene->Lights().LightCount(), 1u);
    ASSERT_EQ(m.built.scene->Lights()[LightId(1u)].Surface().primitive, 0u);
    std::set<uint32_t> voxels;
    for (size_t i = 0; i < m.targets.Size(); ++i) voxels.insert(m.targets[i].index);
    EXPECT_EQ(voxels, (std::set<uint32_t>{m.grid.Index({-2.5f, 0.5f, 0.5f}), m.grid.Index({2.5f, 0.5f, 0.5f})}));
}

}  // namespace
