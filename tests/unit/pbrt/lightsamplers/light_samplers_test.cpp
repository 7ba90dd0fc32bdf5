#include <gtest/gtest.h>

#include "candidates.h"
#include "pbrt/lightsamplers/bvh_light_sampler.h"
#include "pbrt/lightsamplers/exhaustive_light_sampler.h"
#include "pbrt/lightsamplers/simple_light_samplers.h"
#include "support/given_lights.h"

namespace pbrt::test {
namespace {

LightQuery Query(const Point3 &p, const Normal3 &n = Normal3(0), const Normal3 &ns = Normal3(0)) {
    return {.p = p, .n = n, .ns = ns};
}

TEST(UniformLightSampler, DividesTheUnitIntervalEvenly) {
    std::vector<LightCandidate> c(3);
    const auto table = TableOf(c);
    UniformLightSampler sampler(table->ByComponent());
    EXPECT_EQ(sampler.Sample({}, 0)->light, LightId(0u));
    EXPECT_EQ(sampler.Sample({}, 0.5f)->light, LightId(1u));
    EXPECT_EQ(sampler.Sample({}, OneMinusEpsilon)->light, LightId(2u));
    EXPECT_EQ(sampler.Sample({}, 0.5f)->pmf, Float(1) / 3);
    EXPECT_EQ(sampler.PMF({}, LightId(3u)), 0);
}

TEST(PowerLightSampler, FollowsPower) {
    std::vector<LightCandidate> c(3);
    c[0].power = 1;
    c[2].power = 3;
    const auto table = TableOf(c);
    PowerLightSampler sampler(table->ByComponent());
    EXPECT_FLOAT_EQ(sampler.PMF({}, LightId(0u)), 0.25f);
    EXPECT_EQ(sampler.PMF({}, LightId(1u)), 0);
    EXPECT_FLOAT_EQ(sampler.PMF({}, LightId(2u)), 0.75f);
}

TEST(PowerLightSampler, IsUniformIfNothingHasPower) {
    std::vector<LightCandidate> c(4);
    const auto table = TableOf(c);
    PowerLightSampler sampler(table->ByComponent());
    for (uint32_t i = 0; i < 4; ++i) EXPECT_FLOAT_EQ(sampler.PMF({}, LightId(i)), 0.25f);
}

template <class Sampler>
class ByBounds : public testing::Test {};
using Samplers = testing::Types<BVHLightSampler, ExhaustiveLightSampler>;
TYPED_TEST_SUITE(ByBounds, Samplers);

TYPED_TEST(ByBounds, EveryInfiniteLightCountsLikeAllBoundedOnesTogether) {
    std::vector<LightCandidate> c = RandomCandidates(1, 5);
    c.insert(c.begin() + 2, InfiniteCandidate());
    c.push_back(InfiniteCandidate(0));
    const auto table = TableOf(c);
    TypeParam sampler(table->ByComponent());
    LightQuery q = Query({3, 2, 1});
    EXPECT_FLOAT_EQ(sampler.PMF(q, LightId(2u)), Float(1) / 3);
    EXPECT_FLOAT_EQ(sampler.PMF(q, LightId(6u)), Float(1) / 3);
    Float rest = 0;
    for (uint32_t i : {0u, 1u, 3u, 4u, 5u}) rest += sampler.PMF(q, LightId(i));
    EXPECT_NEAR(rest, Float(1) / 3, 1e-5);
    EXPECT_EQ(sampler.Sample(q, 0)->light, LightId(2u));
    EXPECT_EQ(sampler.Sample(q, 0.6f)->light, LightId(6u));
}

TYPED_TEST(ByBounds, ReturnsNothingWhereNoLightShines) {
    std::vector<LightCandidate> c = {Bounded({.bounds = Bounds3(Point3(0)), .w = {0, 0, 1}, .phi = 1})};
    const auto table = TableOf(c);
    TypeParam sampler(table->ByComponent());
    EXPECT_FALSE(sampler.Sample(Query({0, 0, -1}), 0.3f));
    EXPECT_EQ(sampler.PMF(Query({0, 0, -1}), LightId(0u)), 0);
    ASSERT_TRUE(sampler.Sample(Query({0, 0, 1}), 0.3f));
    EXPECT_EQ(sampler.Sample(Query({0, 0, 1}), 0.3f)->pmf, 1);
}

TYPED_TEST(ByBounds, LightsWithoutPowerAreNeverChosen) {
    std::vector<LightCandidate> c = RandomCandidates(1, 3);
    c[1].bounds.reset();
    c[1].power = 0;
    const auto table = TableOf(c);
    TypeParam sampler(table->ByComponent());
    EXPECT_EQ(sampler.PMF(Query({0, 0, 0}), LightId(1u)), 0);
}

TEST(ExhaustiveLightSampler, PmfIsTheShareOfImportanceWithTheGeometricNormal) {
    for (int count : {2, 100, 128, 129, 1000}) {
        std::vector<LightCandidate> c = RandomCandidates(5, count);
        const auto table = TableOf(c);
        ExhaustiveLightSampler sampler(table->ByComponent());
        Rng rng(3);
        for (int q = 0; q < 20; ++q) {
            LightQuery query = Query({2 * rng.Uniform(), rng.Uniform(), rng.Uniform()},
                                     SampleUniformSphere(rng.Uniform2()), SampleUniformSphere(rng.Uniform2()));
            double total = 0;
            for (const LightCandidate &l : c) total += double(l.bounds->Importance(query.p, query.n));
            for (uint32_t i = 0; i < c.size(); ++i) {
                double share = double(c[i].bounds->Importance(query.p, query.n)) / total;
                ASSERT_NEAR(double(sampler.PMF(query, LightId(i))), share, 1e-6 + 1e-5 * share);
            }
        }
    }
}

TEST(ExhaustiveLightSampler, InvertsItsCumulativeDistribution) {
    std::vector<LightCandidate> c = RandomCandidates(6, 300);
    const auto table = TableOf(c);
    ExhaustiveLightSampler sampler(table->ByComponent());
    LightQuery query = Query({0.2f, 0.4f, 1.5f});
    double below = 0;
    for (uint32_t i = 0; i < c.size(); ++i) {
        double p = double(sampler.PMF(query, LightId(i)));
        if (p > 1e-5) {
            auto s = sampler.Sample(query, Float(below + p / 2));
            ASSERT_TRUE(s);
            EXPECT_EQ(s->light.value, i);
        }
        below += p;
    }
    EXPECT_NEAR(below, 1, 1e-4);
}

TEST(BVHLightSampler, PmfIsTheProductOfChildSharesWithTheShadingNormal) {
    std::vector<LightCandidate> c = RandomCandidates(8, 64);
    c.push_back(InfiniteCandidate());
    const auto table = TableOf(c);
    BVHLightSampler sampler(table->ByComponent());
    const LightBvh &tree = sampler.Tree();
    Rng rng(3);
    for (int q = 0; q < 50; ++q) {
        LightQuery query = Query({2 * rng.Uniform(), rng.Uniform(), rng.Uniform()}, SampleUniformSphere(rng.Uniform2()),
                                 SampleUniformSphere(rng.Uniform2()));
        for (uint32_t light = 0; light < 64; ++light) {
            // The expected PMF, in double, by following the trail of the leaf from the root.
            double expected = 0.5;
            LightBvhNode node = tree.Root();
            for (uint64_t trail = tree.Trail(light); !node.IsLeaf() && expected > 0; trail >>= 1) {
                double w[2];
                for (uint32_t i = 0; i < 2; ++i)
                    w[i] = double(tree.Child(node, i).Sphere().Importance(query.p, query.ns));
                expected = w[trail & 1] > 0 ? expected * w[trail & 1] / (w[0] + w[1]) : 0;
                node = tree.Child(node, trail & 1);
            }
            ASSERT_NEAR(double(sampler.PMF(query, LightId(light))), expected, 1e-3 * expected + 1e-9);
        }
    }
}

}  // namespace
}  // namespace pbrt::test
