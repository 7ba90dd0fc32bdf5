#include "pbrt/lights/light_table.h"

#include <gtest/gtest.h>

#include "light_test_support.h"

namespace pbrt::test {
namespace {

TEST(LightTable, KeepsOrderAndKnowsWhoIsInfinite) {
    LightTable table;
    LightId point = table.Add(Make("point", Params()));
    LightId sky = table.Add(Make("infinite", Params()));
    LightId sun = table.Add(Make("distant", Params()));
    LightId area = table.Add(Make("point", Params()), ShapeId(7u), 3);
    table.Finish({0, 0, 0}, 5);
    ASSERT_EQ(table.Size(), 4u);
    EXPECT_EQ(area.value, 3u);
    EXPECT_EQ(table.MeshOf(area), ShapeId(7u));
    EXPECT_EQ(table.PrimitiveOf(area), 3u);
    EXPECT_FALSE(table.MeshOf(point));
    // Rays that leave the scene ask the sky only; light selection treats the sun as infinite too.
    ASSERT_EQ(table.Infinite().size(), 1u);
    EXPECT_EQ(table.Infinite()[0], sky);
    EXPECT_TRUE(table.Candidates()[sky.value].infinite);
    EXPECT_TRUE(table.Candidates()[sun.value].infinite);
    EXPECT_FALSE(table.Candidates()[point.value].infinite);
    EXPECT_FALSE(table.Candidates()[sky.value].bounds);
    EXPECT_TRUE(table.Candidates()[point.value].bounds);
}

TEST(LightTable, PowerIsPhiAveragedOverTheVisibleWavelengths) {
    LightTable table;
    table.Add(Make("point", Params().Rgb("I", 1, 0.2f, 0.1f)));
    table.Add(Make("point", Params().Rgb("I", 2, 0.4f, 0.2f)));
    table.Add(Make("point", Params().Number("scale", 0)));
    table.Finish({0, 0, 0}, 1);
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    Float expected = SafeDivide(table[LightId(0u)].Phi(lambda), lambda.Pdf()).Average();
    EXPECT_FLOAT_EQ(table.Candidates()[0].power, expected);
    EXPECT_NEAR(table.Candidates()[1].power / expected, 2, 1e-3);
    EXPECT_EQ(table.Candidates()[2].power, 0);
    EXPECT_FALSE(table.Candidates()[2].bounds) << "no power, no bounds";
}

}  // namespace
}  // namespace pbrt::test
