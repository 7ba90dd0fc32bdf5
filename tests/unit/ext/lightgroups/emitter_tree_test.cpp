#include "ext/lightgroups/emitter_tree.h"

#include <gtest/gtest.h>

#include "emitters.h"
#include "pbrt/core/parallel.h"

namespace {

using namespace ext;

using test::PatchCounts;
using test::Patches;
using test::QueryIn;

class EmitterTreeOfSize : public testing::TestWithParam<PatchCounts> {};

TEST_P(EmitterTreeOfSize, EveryEmitterIsInItOnceAndSampledAsItsPmfSays) {
    const auto [count, far] = GetParam();
    const std::vector<Emitter> emitters = Patches(count, far);
    EmitterTree tree(emitters);
    Rng rng(3);
    for (int k = 0; k < 20; ++k) {
        const LightQuery q = QueryIn(rng);
        double sum = 0;
        for (uint32_t i = 0; i < emitters.size(); ++i) {
            const Float pmf = tree.PMF(q, i);
            sum += static_cast<double>(pmf);
            // An emitter can be chosen exactly if it can contribute.
            EXPECT_EQ(pmf > 0, test::GOf(emitters[i], q) > 0) << i;
        }
        // The sum is less than 1 where a node has importance, but the nodes below it have none: then no emitter is
        // chosen.
        EXPECT_LE(sum, 1.0001);
        constexpr int kSamples = 2000;
        int chosenCount = 0;
        for (int s = 0; s < kSamples; ++s)
            if (std::optional<SampledLight> chosen = tree.Sample(q, rng.Uniform())) {
                ++chosenCount;
                EXPECT_EQ(chosen->pmf, tree.PMF(q, chosen->light.value));
            }
        EXPECT_NEAR(static_cast<double>(chosenCount) / kSamples, sum, 5 * std::sqrt(0.25 / kSamples));
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, EmitterTreeOfSize,
                         testing::Values(PatchCounts{1, 0}, PatchCounts{7, 2}, PatchCounts{33, 0}, PatchCounts{100, 1},
                                         PatchCounts{1100, 3}),
                         [](const auto &p) {
                             return std::to_string(p.param.count) + "And" + std::to_string(p.param.far) + "Far";
                         });

/// The tree is large enough to be built as several tasks.
TEST(EmitterTree, IsTheSameForAnyNumberOfThreads) {
    const std::vector<Emitter> emitters = Patches(20000, 1);
    std::vector<std::optional<SampledLight>> found[2];
    for (int k = 0; k < 2; ++k) {
        ThreadLimit limit(k + 1);
        EmitterTree tree(emitters);
        Rng rng(5);
        for (int i = 0; i < 2000; ++i) {
            const LightQuery q = QueryIn(rng);
            found[k].push_back(tree.Sample(q, rng.Uniform()));
        }
    }
    for (size_t i = 0; i < found[0].size(); ++i) {
        ASSERT_EQ(found[0][i].has_value(), found[1][i].has_value());
        if (!found[0][i]) continue;
        EXPECT_EQ(found[0][i]->light, found[1][i]->light);
        EXPECT_EQ(found[0][i]->pmf, found[1][i]->pmf);
    }
}

TEST(EmitterTree, GrowsWithTheEmittersAndItsDepthWithTheirLogarithm) {
    for (int count : {100, 10000, 100000}) {
        EmitterTree tree(Patches(count, 0));
        EXPECT_LT(static_cast<double>(tree.Bytes()), 130.0 * count) << count;
        EXPECT_LE(tree.Depth(), 5) << count;
    }
}

TEST(EmitterTree, WithoutEmittersChoosesNothing) {
    EmitterTree tree(std::vector<Emitter>{});
    EXPECT_FALSE(tree.Sample(LightQuery(), 0.5f));
}

}  // namespace
