#include "pbrt/lights/light_table.h"

#include <gtest/gtest.h>

#include "light_test_support.h"
#include "support/given_lights.h"

namespace pbrt::test {
namespace {

TEST(LightTable, KeepsOrderAndKnowsWhoIsInfinite) {
    LightTable table;
    LightId point = table.Add(Make("point", Params()));
    LightId sky = table.Add(Make("infinite", Params()));
    LightId sun = table.Add(Make("distant", Params()));
    LightId mesh = table.Add(std::make_unique<GivenLight>(std::vector<LightCandidate>(3)));
    LightId last = table.Add(Make("point", Params()));
    table.Finish({0, 0, 0}, 5);
    ASSERT_EQ(table.Size(), 7u);
    ASSERT_EQ(table.WholeCount(), 5u);
    EXPECT_EQ(mesh.value, 3u);
    EXPECT_EQ(last.value, 6u) << "each of the three parts must have an id";
    EXPECT_EQ(table.WholeOf(LightId(5u)), 3u);
    EXPECT_EQ(table.WholeOf(point), 0u);
    EXPECT_EQ(&table[LightId(5u)].Whole(), &table[mesh].Whole());
    // Only the sky emits along rays that leave the scene; light selection treats the sun as infinite, too.
    std::vector<LightId> met;
    table.ForEachBeyond(Point3(0), Vector3(0, 0, 1), SampledWavelengths::SampleVisible(0.5f),
                        [&](const SampledSpectrum &Le, LightId id) {
                            EXPECT_GT(Le.Average(), 0);
                            met.push_back(id);
                        });
    EXPECT_EQ(met, std::vector<LightId>{sky});
    EXPECT_TRUE(table.Candidate(sky).infinite);
    EXPECT_TRUE(table.Candidate(sun).infinite);
    EXPECT_FALSE(table.Candidate(point).infinite);
    EXPECT_FALSE(table.Candidate(sky).bounds);
    EXPECT_TRUE(table.Candidate(point).bounds);
}

TEST(LightTable, PowerIsPhiAveragedOverTheVisibleWavelengths) {
    LightTable table;
    table.Add(Make("point", Params().Rgb("I", 1, 0.2f, 0.1f)));
    table.Add(Make("point", Params().Rgb("I", 2, 0.4f, 0.2f)));
    table.Add(Make("point", Params().Number("scale", 0)));
    table.Finish({0, 0, 0}, 1);
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    Float expected = SafeDivide(table[LightId(0u)].Phi(lambda), lambda.Pdf()).Average();
    EXPECT_FLOAT_EQ(table.Candidate(LightId(0u)).power, expected);
    EXPECT_NEAR(table.Candidate(LightId(1u)).power / expected, 2, 1e-3);
    EXPECT_EQ(table.Candidate(LightId(2u)).power, 0);
    EXPECT_FALSE(table.Candidate(LightId(2u)).bounds) << "no power, no bounds";
}

}  // namespace
}  // namespace pbrt::test
