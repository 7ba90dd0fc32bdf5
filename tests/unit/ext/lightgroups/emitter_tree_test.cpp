#include "ext/lightgroups/emitter_tree.h"

#include <gtest/gtest.h>

#include "emitters.h"
#include "support/threads.h"

namespace {

using namespace ext;
using test::OnThreads, test::PatchCounts, test::Patches, test::QueryIn;

class EmitterTreeOfSize : public testing::TestWithParam<PatchCounts> {};

TEST_P(EmitterTreeOfSize, EveryEmitterIsInItOnceAndSampledByItsPmf) {
    const auto [count, far] = GetParam();
    const std::vector<Emitter> emitters = Patches(count, far);
    EmitterTree tree(emitters);
    Rng rng(3);
    for (int k = 0; k < 20; ++k) {
        const LightQuery q = QueryIn(rng);
        double sum = 0;
        for (uint32_t i = 0; i < emitters.size(); ++i) {
            const Float pmf = tree.PMF(q, i);
            sum += double(pmf);
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
        EXPECT_NEAR(double(chosenCount) / kSamples, sum, 5 * std::sqrt(0.25 / kSamples));
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, EmitterTreeOfSize,
                         testing::Values(PatchCounts{1, 0}, PatchCounts{7, 2}, PatchCounts{33, 0}, PatchCounts{100, 1},
                                         PatchCounts{1100, 3}),
                         test::NameOf);

/// The tree is large enough to be built as several tasks.
TEST(EmitterTree, IsTheSameForAnyNumberOfThreads) {
    const std::vector<Emitter> emitters = Patches(20000, 1);
    const auto sample = [&] {
        EmitterTree tree(emitters);
        Rng rng(5);
        std::vector<std::pair<uint32_t, Float>> found;
        for (int i = 0; i < 2000; ++i) {
            const LightQuery q = QueryIn(rng);
            const std::optional<SampledLight> light = tree.Sample(q, rng.Uniform());
            found.emplace_back(light ? light->light.value : 0, light ? light->pmf : 0);
        }
        return found;
    };
    EXPECT_EQ(OnThreads(1, sample), OnThreads(2, sample));
}

TEST(EmitterTree, GrowsWithTheEmittersAndItsDepthWithTheirLogarithm) {
    for (int count : {100, 10000, 100000}) {
        EmitterTree tree(Patches(count, 0));
        EXPECT_LT(double(tree.Bytes()), 130.0 * count) << count;
        EXPECT_LE(tree.Depth(), 5) << count;
    }
}

TEST(EmitterTree, WithoutEmittersChoosesNothing) {
    EmitterTree tree(std::vector<Emitter>{});
    EXPECT_FALSE(tree.Sample(LightQuery(), 0.5f));
}

}  // namespace
