#include "ext/lightgroups/light_tree.h"

#include <gtest/gtest.h>

#include "emitters.h"
#include "support/threads.h"

namespace {

using namespace ext;
using test::PatchCounts, test::Patches, test::QueryIn;

class LightTreeOfSize : public testing::TestWithParam<PatchCounts> {
  protected:
    /// A cut somewhere between the roots and the single lights.
    static std::vector<uint32_t> SomeCut(const LightTree &tree, Rng &rng) {
        std::vector<uint32_t> cut, open(tree.Roots().rbegin(), tree.Roots().rend());
        while (!open.empty()) {
            const uint32_t node = open.back();
            open.pop_back();
            if (tree.HasChildren(node) && rng.Uniform() < 0.7f) {
                open.push_back(tree.Second(node));
                open.push_back(tree.First(node));
            } else {
                cut.push_back(node);
            }
        }
        return cut;
    }
};

TEST_P(LightTreeOfSize, EveryCutHoldsEveryLightOnce) {
    const auto [count, far] = GetParam();
    const LightTree tree(Patches(count, far));
    Rng rng(1);
    for (int k = 0; k < 20; ++k) {
        const std::vector<uint32_t> some = SomeCut(tree, rng);
        for (std::span<const uint32_t> cut : {tree.BaseCut(), std::span<const uint32_t>(some)}) {
            ASSERT_TRUE(std::is_sorted(cut.begin(), cut.end()));
            uint32_t next = 0;
            for (size_t i = 0; i < cut.size(); ++i) {
                const LightTree::Range range = tree.At(cut[i]);
                ASSERT_EQ(range.begin, next);
                next = range.end;
                for (uint32_t position = range.begin; position < range.end; ++position) {
                    EXPECT_EQ(tree.FindInCut(cut, position), i);
                    EXPECT_EQ(tree.PositionOf(tree.LightAt(position)), position);
                }
            }
            EXPECT_EQ(next, uint32_t(count + far));
        }
    }
    EXPECT_LE(tree.BaseCut().size(), LightTree::kBaseNodes + LightTree::kFarNodes);
    EXPECT_LE(tree.FarNodeCount(), LightTree::kFarNodes);
}

TEST_P(LightTreeOfSize, ANodeCanBeChosenWhereverOneOfItsLightsCanContribute) {
    const auto [count, far] = GetParam();
    const std::vector<Emitter> emitters = Patches(count, far);
    const LightTree tree(emitters);
    Rng rng(2);
    for (int k = 0; k < 20; ++k) {
        const LightQuery q = QueryIn(rng);
        for (uint32_t node = 0; node < tree.NodeCount(); ++node) {
            Float g = 0, below = 0;
            tree.Evaluate(q, {&node, 1}, {&g, 1});
            for (uint32_t position = tree.At(node).begin; position < tree.At(node).end; ++position)
                below += test::GOf(emitters[tree.LightAt(position)], q);
            EXPECT_TRUE(g > 0 || !(below > 0)) << node;
            if (tree.IsLight(node)) {
                EXPECT_EQ(g, below);
            }
        }
    }
}

TEST_P(LightTreeOfSize, LightsBelowANodeAreSampledByTheirPmf) {
    const auto [count, far] = GetParam();
    const LightTree tree(Patches(count, far));
    Rng rng(3);
    for (int k = 0; k < 10; ++k) {
        const LightQuery q = QueryIn(rng);
        for (uint32_t node : SomeCut(tree, rng)) {
            const LightTree::Range range = tree.At(node);
            std::vector<double> pmf;
            double sum = 0;
            for (uint32_t position = range.begin; position < range.end; ++position) {
                pmf.push_back(double(tree.PMFWithin(node, q, position)));
                sum += pmf.back();
            }
            // The sum is less than 1 where a node has importance, but both of its children have none: then no light is
            // chosen.
            EXPECT_LE(sum, 1.0001);
            constexpr int kSamples = 400;
            std::vector<int> chosen(pmf.size(), 0);
            for (int s = 0; s < kSamples; ++s)
                if (std::optional<SampledLight> light =
                        tree.SampleWithin(node, q, (Float(s) + rng.Uniform()) / kSamples)) {
                    const uint32_t position = tree.PositionOf(light->light.value);
                    ASSERT_TRUE(position >= range.begin && position < range.end);
                    EXPECT_EQ(light->pmf, tree.PMFWithin(node, q, position));
                    ++chosen[position - range.begin];
                }
            // Stratified random numbers: the count of a light differs from its expectation by less than 2.5.
            for (size_t i = 0; i < pmf.size(); ++i) EXPECT_NEAR(chosen[i], kSamples * pmf[i], 2.5);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, LightTreeOfSize,
                         testing::Values(PatchCounts{1, 0}, PatchCounts{0, 3}, PatchCounts{7, 2}, PatchCounts{65, 0},
                                         PatchCounts{300, 40}),
                         test::NameOf);

/// The tree is large enough to be built as several tasks.
TEST(LightTree, IsTheSameForAnyNumberOfThreads) {
    const std::vector<Emitter> emitters = Patches(20000, 1);
    const auto build = [&] { return LightTree(emitters); };
    const LightTree one = test::OnThreads(1, build), two = test::OnThreads(2, build);
    ASSERT_EQ(one.NodeCount(), two.NodeCount());
    EXPECT_TRUE(std::ranges::equal(one.BaseCut(), two.BaseCut()));
    for (uint32_t node = 0; node < one.NodeCount(); ++node) {
        ASSERT_EQ(one.At(node), two.At(node));
        ASSERT_EQ(one.Intensity(node), two.Intensity(node));
    }
    for (uint32_t position = 0; position < one.LightCount(); ++position)
        ASSERT_EQ(one.LightAt(position), two.LightAt(position));
}

TEST(LightTree, PutsNeighboursTogetherAndStaysShallow) {
    // Four clouds of 100 lights: the nodes with 100 lights must be the clouds.
    Rng rng(7);
    std::vector<Emitter> emitters;
    for (int i = 0; i < 400; ++i) {
        const Point3 p = Point3(Float(i % 4) * 10, 0, 0) + Vector3(rng.Uniform(), rng.Uniform(), rng.Uniform());
        emitters.push_back(test::Patch(p, Vector3(0, 0, 1), 1));
    }
    const LightTree tree(emitters);
    int clouds = 0;
    for (uint32_t node = 0; node < tree.NodeCount(); ++node) {
        const LightTree::Range range = tree.At(node);
        if (range.Size() != 100) continue;
        ++clouds;
        for (uint32_t position = range.begin; position < range.end; ++position)
            EXPECT_EQ(tree.LightAt(position) % 4, tree.LightAt(range.begin) % 4);
    }
    EXPECT_EQ(clouds, 4);
    std::vector<int> depth(tree.NodeCount(), 0);
    for (uint32_t node = 0; node < tree.NodeCount(); ++node)
        if (tree.HasChildren(node)) depth[tree.First(node)] = depth[tree.Second(node)] = depth[node] + 1;
    EXPECT_LE(*std::max_element(depth.begin(), depth.end()), 24);
}

TEST(LightTree, LightsThatNeverShineAreNotInIt) {
    std::vector<Emitter> emitters = Patches(5, 0);
    emitters[2] = {};
    const LightTree tree(emitters);
    EXPECT_EQ(tree.LightCount(), 4u);
    EXPECT_EQ(tree.PositionOf(2), LightTree::kNowhere);
    EXPECT_EQ(LightTree(std::vector<Emitter>(3)).LightCount(), 0u);
}

}  // namespace
