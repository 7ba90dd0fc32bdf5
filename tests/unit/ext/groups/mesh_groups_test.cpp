#include <gtest/gtest.h>

#include "ext/groups/mesh_light_sampler.h"
#include "support/statistics.h"

namespace {

using namespace ext;

/// A light that has nothing but power.
class PowerOnlyLight final : public Light {
  public:
    explicit PowerOnlyLight(Float power) : Light(LightKind::DeltaPosition), power_(power) {}
    SampledSpectrum Phi(const SampledWavelengths &lambda) const override { return power_ * lambda.Pdf(); }
    std::optional<LightLiSample> SampleLi(const LightSampleContext &, const Point2 &, const SampledWavelengths &, bool) const override { return {}; }
    Float PdfLi(const LightSampleContext &, const Vector3 &, const Point3 &, const Normal3 &, bool) const override { return 0; }
    std::optional<LightBounds> Bounds() const override {
        LightBounds b;
        b.bounds = Bounds3(Point3(power_, 0, 0));
        b.phi = power_;
        return b;
    }

  private:
    Float power_;
};

LightTable MakeTable() {
    LightTable table;
    table.Add(std::make_unique<PowerOnlyLight>(5.f));
    for (Float p : {1.f, 0.f, 3.f, 6.f}) table.Add(std::make_unique<PowerOnlyLight>(p), ShapeId(0u));
    for (Float p : {0.f, 0.f}) table.Add(std::make_unique<PowerOnlyLight>(p), ShapeId(1u));
    table.Add(std::make_unique<PowerOnlyLight>(2.f));
    table.Finish(Point3(0), 1);
    return table;
}

TEST(MeshGroups, APrimitiveBelongsToItsMesh) {
    LightTable table = MakeTable();
    MeshGroups groups(table, true);
    ASSERT_EQ(groups.Size(), 4u);
    std::vector<uint32_t> expected = {0, 1, 1, 1, 1, 2, 2, 3};
    for (uint32_t i = 0; i < expected.size(); ++i) EXPECT_EQ(groups.GroupOf(LightId(i)), expected[i]);
    EXPECT_NEAR(groups.Candidates()[1].power, 10, 1e-5);
    EXPECT_NEAR(groups.Candidates()[1].bounds->phi, 10, 1e-5);
    EXPECT_EQ(groups.Candidates()[1].bounds->bounds.high.x, 6);
    EXPECT_EQ(MeshGroups(table, false).Size(), table.Size());
}

TEST(MeshGroups, SharesFollowPowerAndSumToOne) {
    LightTable table = MakeTable();
    MeshGroups groups(table, true);
    std::vector<double> perGroup(groups.Size(), 0.0);
    for (uint32_t i = 0; i < table.Size(); ++i) perGroup[groups.GroupOf(LightId(i))] += static_cast<double>(groups.ShareOf(LightId(i)));
    for (double sum : perGroup) EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_NEAR(groups.ShareOf(LightId(4u)), 0.6, 1e-6);
    EXPECT_EQ(groups.ShareOf(LightId(2u)), 0.f);
    EXPECT_NEAR(groups.ShareOf(LightId(5u)), 0.5, 1e-6);  // no power at all: equal shares
}

TEST(MeshGroups, SampleLightMatchesShares) {
    LightTable table = MakeTable();
    MeshGroups groups(table, true);
    const int n = 100000;
    std::vector<double> observed(table.Size(), 0.0), expected(table.Size(), 0.0);
    Rng rng(5);
    for (int i = 0; i < n; ++i) ++observed[groups.SampleLight(1, rng.Uniform()).value];
    for (uint32_t i = 1; i < 5; ++i) expected[i] = n * static_cast<double>(groups.ShareOf(LightId(i)));
    EXPECT_GT(pbrt::test::ChiSquareTest(observed, expected), 1e-4);
    EXPECT_EQ(observed[2], 0);
    EXPECT_EQ(groups.SampleLight(1, 0.f).value, 1u);
    EXPECT_EQ(groups.SampleLight(1, OneMinusEpsilon).value, 4u);
}

TEST(MeshGroups, InnerNumberIsUniformWithinAnyPartOfTheOuterOne) {
    // However small the group's share of [0, 1), its inner numbers must cover [0, 1) evenly.
    std::vector<double> observed(64, 0.0), expected(64, 1000000.0 / 64);
    Rng rng(9);
    for (int i = 0; i < 1000000; ++i) {
        Float u = 0.7f + 0.001f * rng.Uniform();
        ++observed[static_cast<size_t>(MeshGroups::InnerNumber(u, Point3(rng.Uniform(), 1, 2)) * 64)];
    }
    EXPECT_GT(pbrt::test::ChiSquareTest(observed, expected), 1e-4);
}

}  // namespace
