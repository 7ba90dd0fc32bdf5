#include <gtest/gtest.h>

#include "support/given_lights.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

/// A light of this power at the point (power, 0, 0).
LightCandidate WithPower(Float power) {
    LightCandidate c;
    c.power = power;
    c.bounds.emplace();
    c.bounds->bounds = Bounds3(Point3(power, 0, 0));
    c.bounds->phi = double(power);
    return c;
}

/// Four lights: one of one part, one of four parts, one of two parts without power, and another of one part.
std::unique_ptr<const LightTable> MakeTable() {
    auto table = std::make_unique<LightTable>();
    for (const std::vector<Float> &powers : {std::vector<Float>{5}, {1, 0, 3, 6}, {0, 0}, {2}}) {
        std::vector<LightCandidate> parts;
        for (Float p : powers) parts.push_back(WithPower(p));
        table->Add(std::make_unique<GivenLight>(parts));
    }
    table->Finish(Point3(0), 1);
    return table;
}

TEST(LightGroups, APartBelongsToItsLight) {
    const auto table = MakeTable();
    const LightGroups &groups = table->ByLight();
    ASSERT_EQ(groups.Size(), 4u);
    std::vector<uint32_t> expected = {0, 1, 1, 1, 1, 2, 2, 3};
    for (uint32_t i = 0; i < expected.size(); ++i) EXPECT_EQ(groups.GroupOf(LightId(i)), expected[i]);
    const double unit = table->Unit();
    EXPECT_NEAR(double(groups.Candidate(1).power) * unit, 10, 1e-5);
    EXPECT_NEAR(groups.Candidate(1).bounds->phi * unit, 10, 1e-5);
    EXPECT_EQ(groups.Candidate(1).bounds->bounds.high.x, 6);
    EXPECT_EQ(table->ByComponent().Size(), table->Size());
    EXPECT_EQ(table->LightOf(LightId(6u)), 2u);
}

TEST(LightGroups, EveryPartAloneIsItsOwnGroup) {
    const auto table = MakeTable();
    const LightGroups &parts = table->ByComponent();
    for (uint32_t i = 0; i < table->Size(); ++i) {
        EXPECT_EQ(parts.GroupOf(LightId(i)), i);
        EXPECT_EQ(parts.FirstOf(i), i);
        EXPECT_EQ(parts.CountOf(i), 1u);
        EXPECT_EQ(parts.ShareOf(LightId(i)), 1);
        EXPECT_EQ(parts.SampleLight(i, 0.9f), LightId(i));
        EXPECT_EQ(parts.Candidate(i).power, table->Candidate(LightId(i)).power);
    }
    EXPECT_EQ(parts.Bytes(), 0u);
}

TEST(LightGroups, SharesFollowPowerAndSumToOne) {
    const auto table = MakeTable();
    const LightGroups &groups = table->ByLight();
    std::vector<double> perGroup(groups.Size(), 0.0);
    for (uint32_t i = 0; i < table->Size(); ++i)
        perGroup[groups.GroupOf(LightId(i))] += double(groups.ShareOf(LightId(i)));
    for (double sum : perGroup) EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_NEAR(groups.ShareOf(LightId(4u)), 0.6, 1e-6);
    EXPECT_EQ(groups.ShareOf(LightId(2u)), 0.f);
    EXPECT_NEAR(groups.ShareOf(LightId(5u)), 0.5, 1e-6);  // without any power, all parts have equal shares
}

TEST(LightGroups, SampleLightMatchesShares) {
    const auto table = MakeTable();
    const LightGroups &groups = table->ByLight();
    const int n = 100000;
    std::vector<double> observed(table->Size(), 0.0), expected(table->Size(), 0.0);
    Rng rng(5);
    for (int i = 0; i < n; ++i) ++observed[groups.SampleLight(1, rng.Uniform()).value];
    for (uint32_t i = 1; i < 5; ++i) expected[i] = n * double(groups.ShareOf(LightId(i)));
    EXPECT_GT(ChiSquareTest(observed, expected), 1e-4);
    EXPECT_EQ(observed[2], 0);
    EXPECT_EQ(groups.SampleLight(1, 0.f).value, 1u);
    EXPECT_EQ(groups.SampleLight(1, OneMinusEpsilon).value, 4u);
}

TEST(LightGroups, InnerNumberIsUniformWithinAnyPartOfTheOuterOne) {
    // However small the share of a group is, the random numbers passed on to its parts must cover [0, 1) evenly.
    std::vector<double> observed(64, 0.0), expected(64, 1000000.0 / 64);
    Rng rng(9);
    for (int i = 0; i < 1000000; ++i) {
        Float u = 0.7f + 0.001f * rng.Uniform();
        ++observed[size_t(LightGroups::InnerNumber(u, Point3(rng.Uniform(), 1, 2)) * 64)];
    }
    EXPECT_GT(ChiSquareTest(observed, expected), 1e-4);
}

}  // namespace
}  // namespace pbrt::test
