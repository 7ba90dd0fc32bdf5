
#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "candidates.h"
#include "pbrt/lightsamplers/bvh_light_sampler.h"
#include "support/given_lights.h"
#include "support/light_query.h"

namespace pbrt::test {
namespace {

/// The emitter without the thousandth of a radian by which Importance lets it shine too far. Axes are rounded by less.
LightBounds WithoutSlack(LightBounds b) {
    b.cosTheta_e = std::cos(std::acos(b.cosTheta_e) - Float(0.001));
    return b;
}

TEST(LightBvhNode, RoundedBoundsNeverHideTheLight) {
    Rng rng(1);
    int seen = 0;
    for (int i = 0; i < 20000; ++i) {
        LightBounds b = RandomEmitter(rng);
        LightSphere s = LightBvhNode(b, true, 0).Sphere();
        EXPECT_EQ(s.twoSided, b.twoSided);
        for (int j = 0; j < 10; ++j) {
            Point3 p = Point3(0.5f) + SampleUniformSphere(rng.Uniform2()) * (2 * rng.Uniform());
            Normal3 n = j % 2 ? SampleUniformSphere(rng.Uniform2()) : Normal3(0);
            if (!(WithoutSlack(b).Importance(p, n) > 0)) continue;
            ++seen;
            ASSERT_GT(s.Importance(p, n), 0);
        }
    }
    EXPECT_GT(seen, 50000);
}

TEST(LightBvhBlock, AllNodesAtOnceEqualOneByOne) {
    constexpr uint32_t kLanes = LightBvhBlock::kLanes;
    Rng rng(3);
    int seen = 0;
    for (int i = 0; i < 5000; ++i) {
        std::array<LightBounds, kLanes> b;
        LightBvhBlock block;
        const uint32_t empty = uint32_t(i) % kLanes;
        for (uint32_t k = 0; k < kLanes; ++k) {
            b[k] = RandomEmitter(rng);
            if (k != empty) block.Set(k, LightBvhNode(b[k], k % 2 == 0, k));
        }
        for (int j = 0; j < 10; ++j) {
            Point3 p = Point3(0.5f) + SampleUniformSphere(rng.Uniform2()) * (2 * rng.Uniform());
            Normal3 n = j % 2 ? SampleUniformSphere(rng.Uniform2()) : Normal3(0);
            Float all[kLanes];
            block.Importances(p, n, all);
            EXPECT_EQ(all[empty], 0);
            for (uint32_t k = 0; k < kLanes; ++k) {
                if (k == empty) continue;
                const LightBvhNode node = block.Node(k);
                EXPECT_EQ(node.Link(), k);
                EXPECT_EQ(node.IsLeaf(), k % 2 == 0);
                EXPECT_EQ(node.Sphere().center, LightBvhNode(b[k], k % 2 == 0, k).Sphere().center);
                Float one = node.Sphere().Importance(p, n);
                // Only at the border of the emission cone may the two differ in being 0, by rounding.
                if (all[k] > 0 && one > 0) {
                    ASSERT_NEAR(all[k] / one, 1, 2e-2) << one;
                }
                if (WithoutSlack(b[k]).Importance(p, n) > 0) {
                    ++seen;
                    ASSERT_GT(all[k], 0);
                }
            }
        }
    }
    EXPECT_GT(seen, 50000);
}

TEST(LightBvhNode, RoundingHardlyChangesImportance) {
    Rng rng(2);
    for (int i = 0; i < 20000; ++i) {
        LightBounds b = RandomEmitter(rng);
        b.cosTheta_o = std::min(b.cosTheta_o, Float(0.9));  // near 1 a 16-bit cosine gives the angle too coarsely
        Point3 p = Point3(0.5f) + SampleUniformSphere(rng.Uniform2()) * (1 + rng.Uniform());
        Float peak = b.Sphere().phi / std::max(DistanceSquared(p, b.Centroid()), Length(b.bounds.Diagonal()) / 2);
        EXPECT_NEAR(LightBvhNode(b, true, 0).Sphere().Importance(p, Normal3(0)), b.Importance(p, Normal3(0)),
                    (b.cosTheta_e > 0 ? 1 : Float(2e-3)) * peak);
    }
}

void ExpectEveryTrailLeadsToItsLight(const std::vector<LightCandidate> &candidates, const LightBvh &tree) {
    for (uint32_t i = 0; i < candidates.size(); ++i) {
        const LightCandidate &c = candidates[i];
        uint64_t trail = tree.Trail(i);
        if (c.infinite || !c.bounds || !(c.bounds->phi > 0)) {
            EXPECT_EQ(trail, LightBvh::NotInTree);
            continue;
        }
        LightBvhNode node = tree.Root();
        for (; !node.IsLeaf(); trail >>= 1) node = tree.Child(node, trail & 1);
        EXPECT_EQ(node.Link(), i);
        EXPECT_EQ(trail, 0u);
    }
}

TEST(LightBvh, EveryTrailLeadsToItsLight) {
    for (int n : {1, 2, 3, 12, 100, 5000}) {
        std::vector<LightCandidate> c = RandomCandidates(7, n);
        c.push_back(InfiniteCandidate());
        c.push_back({});
        LightBvh tree(c);
        EXPECT_EQ(tree.PairCount(), size_t(n - 1));
        ExpectEveryTrailLeadsToItsLight(c, tree);
    }
}

TEST(LightBvh, BlocksAreFull) {
    const LightBvh tree(RandomCandidates(5, 5000));
    const size_t trails = 5000 * sizeof(uint64_t);
    EXPECT_GE(tree.Bytes() - trails, tree.PairCount() * 2 * sizeof(LightBvhNode));
    EXPECT_LE(tree.Bytes() - trails, tree.PairCount() * 2 * sizeof(LightBvhNode) + sizeof(LightBvhBlock));
}

TEST(LightBvh, CoincidentLightsAreHalved) {
    std::vector<LightCandidate> c(1000, Bounded(RandomCandidates(3, 1)[0].bounds.value()));
    LightBvh tree(c);
    EXPECT_LE(tree.Depth(), 10);
    ExpectEveryTrailLeadsToItsLight(c, tree);
}

TEST(LightBvh, DepthFitsTheTrailEvenIfEverySplitPeelsOffOneLight) {
    std::vector<LightCandidate> c;
    for (int axis = 0; axis < 3; ++axis)
        for (int k = -36; k <= 36; ++k) {
            LightBounds b;
            Point3 p(0);
            p[axis] = std::pow(Float(10), Float(k) / 2);
            b.bounds = Bounds3(p, p * Float(1.5) + Vector3(1e-18f));
            b.phi = 1;
            c.push_back(Bounded(b));
        }
    LightBvh tree(c);
    EXPECT_LE(tree.Depth(), LightBvh::kMaxDepth);
    ExpectEveryTrailLeadsToItsLight(c, tree);
}

TEST(LightBvh, NodesBelowANodeAreNoMorePowerfulTogether) {
    std::vector<LightCandidate> c = RandomCandidates(11, 500);
    LightBvh tree(c);
    std::function<double(const LightBvhNode &)> check = [&](const LightBvhNode &node) -> double {
        LightSphere s = node.Sphere();
        if (node.IsLeaf()) return double(s.phi);
        const LightBvhNode children[2] = {tree.Child(node, 0), tree.Child(node, 1)};
        double sum = check(children[0]) + check(children[1]);
        EXPECT_NEAR(double(s.phi) / sum, 1, 1e-4);
        for (const LightBvhNode &child : children)
            EXPECT_LE(Distance(child.Sphere().center, s.center), s.radius * 1.0001f + 1e-6f);
        return sum;
    };
    check(tree.Root());
}

TEST(LightBvh, SplittingGroupsByOrientationAndPlaceBeatsChance) {
    // The tree is useful only if its PMF follows the importance of single lights much better than a tree over the
    // lights in arbitrary order. Measured by the mean absolute difference from the PMF of the single lights.
    std::vector<LightCandidate> c = RandomCandidates(13, 256);
    const auto table = TableOf(c);
    BVHLightSampler bvh(table->ByComponent());
    Rng rng(1);
    double distance = 0;
    constexpr int kQueries = 200;
    for (int q = 0; q < kQueries; ++q) {
        const LightQuery query = QueryAt({rng.Uniform(), rng.Uniform(), rng.Uniform()});
        double total = 0;
        for (const LightCandidate &light : c) total += double(light.bounds->Importance(query.p, Normal3(0)));
        for (uint32_t i = 0; i < c.size(); ++i)
            distance += std::abs(double(bvh.PMF(query, LightId(i))) -
                                 double(c[i].bounds->Importance(query.p, Normal3(0))) / total);
    }
    EXPECT_LT(distance / kQueries / 2, 0.5) << "total variation distance";
}

}  // namespace
}  // namespace pbrt::test
