#include "ext/visibility/visibility_tree_builder.h"

#include <gtest/gtest.h>

#include "pbrt/math/rng.h"
#include "support/threads.h"

namespace {

using namespace ext;

const Bounds3 kBounds(Point3(0), Point3(1));

/// Records all over the box with one try per light; `found(p, light, u)` is the ratio that a shadow ray finds.
struct Prepass {
    std::vector<VisibilityRecord> records;
    std::vector<ShadowRay> rays;

    template <class Found>
    Prepass(int count, uint32_t lights, Found &&found, uint64_t seed = 1) {
        Rng rng(seed);
        for (int i = 0; i < count; ++i) {
            Point3 p(rng.Uniform(), rng.Uniform(), rng.Uniform());
            records.push_back({p, uint32_t(rays.size()), lights});
            for (uint32_t l = 0; l < lights; ++l) {
                Float share = 1 / Float(lights);
                rays.push_back({l, share, share, Float(found(p, l, rng.Uniform()))});
            }
        }
    }
    VisibilityTree Build(VisibilityBuildSettings settings) const {
        return VisibilityTreeBuilder(kBounds, records, rays, settings).Build().value();
    }
};

VisibilityBuildSettings Settings(int lights) { return {.lightCount = lights}; }

Float FactorAt(const VisibilityTree &tree, const Point3 &p, uint32_t light) {
    VisibilityTree::Row row = tree.RowAt(p);
    return VisibilityTree::Decode(row.codes[light]);
}

TEST(VisibilityTree, CodesKeepFactorsWithinAFewPercent) {
    for (double a = 1e-6; a < 100; a *= 1.37)
        EXPECT_NEAR(double(VisibilityTree::Decode(VisibilityTree::Encode(a))) / a, 1, 0.05);
    EXPECT_GT(VisibilityTree::Decode(VisibilityTree::Encode(0)), 0);
}

TEST(VisibilityTree, AnOpenSceneEndsWithOneLeaf) {
    // A cell is not divided if all records agree, or if they differ by noise only.
    Prepass clear(20000, 5, [](const Point3 &, uint32_t, Float) { return Float(1); });
    Prepass noisy(20000, 5, [](const Point3 &, uint32_t, Float u) { return u < 0.5f ? Float(2) : Float(0); });
    for (const Prepass *prepass : {&clear, &noisy}) {
        VisibilityTree tree = prepass->Build(Settings(5));
        EXPECT_EQ(tree.LeafCount(), 1u);
        EXPECT_EQ(tree.Depth(), 0);
        EXPECT_EQ(tree.RowCount(), 1u);
    }
}

TEST(VisibilityTree, AWallIsLearned) {
    // Light 0 is seen left of x = 0.3, light 1 right of it, light 2 everywhere.
    auto seen = [](const Point3 &p, uint32_t l) { return l == 2 || (l == 0) == (p.x < 0.3f); };
    Prepass prepass(40000, 3, [&](const Point3 &p, uint32_t l, Float) { return seen(p, l); });
    VisibilityTree tree = prepass.Build(Settings(3));
    EXPECT_GT(tree.LeafCount(), 8u);
    Rng rng(9);
    for (int i = 0; i < 200; ++i) {
        Point3 p(rng.Uniform(), rng.Uniform(), rng.Uniform());
        if (std::abs(p.x - 0.3f) < 0.1f) continue;
        EXPECT_GT(FactorAt(tree, p, p.x < 0.3f ? 0 : 1), 5 * FactorAt(tree, p, p.x < 0.3f ? 1 : 0)) << p.x;
        EXPECT_NEAR(FactorAt(tree, p, 2), FactorAt(tree, p, p.x < 0.3f ? 0 : 1), 0.15f);
    }
}

/// A closed room: light 0 would shine `strength` times as strong as light 1 on every second record, but reaches none.
VisibilityTree BesideAHiddenLight(Float strength) {
    Prepass prepass(4000, 2, [](const Point3 &, uint32_t l, Float) { return l == 1; });
    for (size_t i = 0; i < prepass.records.size(); ++i) {
        ShadowRay *const rays = &prepass.rays[2 * i];
        rays[1].share = rays[1].weight = i % 2 == 0 ? 1 / (1 + strength) : 1;
        rays[0].share = rays[0].weight = 1 - rays[1].share;
    }
    return prepass.Build(Settings(2));
}
Float HiddenFactor(const VisibilityTree &tree) {
    return FactorAt(tree, Point3(0.4f), 0) / FactorAt(tree, Point3(0.4f), 1);
}

TEST(VisibilityTree, AStrongLightBehindAWallStarvesNoWeakOne) {
    const VisibilityTree tree = BesideAHiddenLight(1000);
    EXPECT_GT(tree.LeafCount(), 8u);
    EXPECT_LT(HiddenFactor(tree), 0.02f);
}

TEST(VisibilityTree, LightsThatWereNeverReachedGetAtMostHalfOfTheProbability) {
    // Codes have steps of 9 %.
    EXPECT_LT(HiddenFactor(BesideAHiddenLight(1e6f)), 1.1e-6f);
}

TEST(VisibilityTree, KeepsAllSplitsWithoutPruningAndHoldsFewRecordsPerLeaf) {
    Prepass prepass(20000, 2, [](const Point3 &, uint32_t, Float) { return Float(1); });
    VisibilityBuildSettings settings = Settings(2);
    settings.pruneGain = 0;
    VisibilityTreeBuilder builder(kBounds, prepass.records, prepass.rays, settings);
    VisibilityTree tree = builder.Build().value();
    EXPECT_EQ(tree.LeafCount(), builder.LeavesBeforePruning());
    EXPECT_GT(tree.LeafCount(), 50u);
    uint32_t total = 0;
    for (const LeafSize &leaf : builder.Leaves()) {
        EXPECT_LE(leaf.records, 200u);
        total += leaf.records;
    }
    EXPECT_EQ(total, 20000u);
    EXPECT_EQ(tree.RowCount(), 1u);  // all rows are equal, so one is stored
}

TEST(VisibilityTree, ShrinkageKeepsUnseenLightsAlive) {
    // In a corner light 0 is not seen: without shrinkage, its few records there would be taken for certain.
    Prepass prepass(4000, 2, [](const Point3 &p, uint32_t l, Float) { return l == 1 || p.x > 0.25f || p.y > 0.25f; });
    VisibilityBuildSettings settings = Settings(2);
    settings.records = 5;
    settings.pruneGain = 0;
    Point3 corner(0.05f, 0.05f, 0.5f);
    Float kept = FactorAt(prepass.Build(settings), corner, 0);
    settings.shrinkage = 0;
    Float lost = FactorAt(prepass.Build(settings), corner, 0);
    EXPECT_GT(kept, 0.05f);
    EXPECT_LT(lost, 1e-4f);
}

/// 500 lights along x; from p only those at nearly the same x are seen.
struct ManyLights {
    static constexpr uint32_t kLights = 500;
    LightTree tree;
    std::vector<VisibilityRecord> records;
    std::vector<ShadowRay> rays;

    ManyLights() {
        std::vector<Emitter> emitters(kLights);
        for (uint32_t l = 0; l < kLights; ++l) {
            const Point3 p(PlaceOf(l), 0.5f, 0.5f);
            emitters[l] = {.bounds = LightBounds{.bounds = Bounds3(p, p), .phi = 1, .cosTheta_o = -1}, .intensity = 1};
        }
        tree = LightTree(emitters);
        Rng rng(3);
        for (int i = 0; i < 20000; ++i) {
            Point3 p(rng.Uniform(), rng.Uniform(), rng.Uniform());
            records.push_back({p, uint32_t(rays.size()), 16});
            for (int k = 0; k < 16; ++k) {
                const uint32_t l = rng.UniformInt(kLights);
                rays.push_back({l, 1.f / kLights, 1.f / 16, std::abs(PlaceOf(l) - p.x) < 0.02f ? Float(1) : Float(0)});
            }
        }
    }
    static Float PlaceOf(uint32_t light) { return Float(light) / kLights; }
    VisibilityTree Build() const {
        VisibilityBuildSettings settings = Settings(kLights);
        settings.lights = &tree;
        return VisibilityTreeBuilder(kBounds, records, rays, settings).Build().value();
    }
};

TEST(VisibilityTree, ManyLightsAreSeparatedWhereTheyMatter) {
    const ManyLights lights;
    const VisibilityTree tree = lights.Build();
    for (uint32_t r = 0; r < tree.RowCount(); ++r) {
        const VisibilityTree::Row row = tree.GetRow(r);
        ASSERT_EQ(row.nodes.size(), row.codes.size());
        EXPECT_LE(row.nodes.size(), 48u);
        // The nodes are a cut of the light tree: they hold every light exactly once.
        uint32_t next = 0;
        for (uint32_t node : row.nodes) {
            EXPECT_EQ(lights.tree.At(node).begin, next);
            next = lights.tree.At(node).end;
        }
        EXPECT_EQ(next, ManyLights::kLights);
    }
    // If G is the same for all lights, the probability of a light is the factor of its node over the sum for all
    // lights.
    for (Float x : {0.2f, 0.5f, 0.8f}) {
        const VisibilityTree::Row row = tree.RowAt(Point3(x, 0.5f, 0.5f));
        double near = 0, all = 0;
        for (uint32_t l = 0; l < ManyLights::kLights; ++l) {
            const size_t i = lights.tree.FindInCut(row.nodes, lights.tree.PositionOf(l));
            const auto a = double(VisibilityTree::Decode(row.codes[i]));
            all += a;
            if (std::abs(ManyLights::PlaceOf(l) - x) < 0.25f) near += a;  // cells are an eighth to a quarter wide
        }
        EXPECT_GT(near, 0.9 * all) << x;
    }
}

TEST(VisibilityTree, ManyLightsDoNotDependOnThreads) {
    const ManyLights lights;
    const auto build = [&] { return lights.Build(); };
    const VisibilityTree one = test::OnThreads(1, build);
    EXPECT_TRUE(one == test::OnThreads(4, build));
    // A leaf holds at most 50 of the 20,000 records.
    EXPECT_GT(one.LeafCount(), 400u);
}

TEST(VisibilityTree, ThreadsDoNotMatter) {
    Prepass prepass(
        30000, 4, [](const Point3 &p, uint32_t l, Float u) { return u < 0.9f && std::abs(p.x - Float(l) / 4) < 0.3f; });
    const auto build = [&] { return prepass.Build(Settings(4)); };
    const VisibilityTree one = test::OnThreads(1, build);
    EXPECT_TRUE(one == test::OnThreads(4, build));
    EXPECT_GT(one.LeafCount(), 1u);
}

TEST(VisibilityTree, NoRecordsAreFine) {
    VisibilityTree tree = VisibilityTreeBuilder(kBounds, {}, {}, Settings(3)).Build().value();
    EXPECT_EQ(tree.LeafCount(), 1u);
    EXPECT_GT(FactorAt(tree, Point3(0.5f), 1), 0);
}

/// Builds again and again, and stops each build at a later step. Every stopped build must end without a tree,
/// and the last build, which is not stopped, must give the whole one.
template <class MakeBuilder>
void ExpectStopsEverywhere(MakeBuilder &&make) {
    int questions = 0;
    const VisibilityTree whole = make()->Build([&] { return ++questions == 0; }).value();
    ASSERT_GT(questions, 100);
    for (int step = 0; step <= 20; ++step) {
        const int last = std::max(1, questions * step / 20);
        int calls = 0;
        // The callback returns true only once: the build must stop then and not call it again.
        const std::optional<VisibilityTree> stopped = make()->Build([&] { return ++calls == last; });
        EXPECT_FALSE(stopped) << "at question " << last << " of " << questions;
        EXPECT_EQ(calls, last) << "the build went on after the stop";
    }
    const std::optional<VisibilityTree> built = make()->Build([] { return false; });
    ASSERT_TRUE(built);
    EXPECT_TRUE(*built == whole);
}

TEST(VisibilityTree, BuildingStopsAtOnceAtEveryStep) {
    ThreadLimit limit(1);
    const Prepass prepass(20000, 3, [](const Point3 &p, uint32_t l, Float) { return (l == 0) == (p.x < 0.3f); });
    ExpectStopsEverywhere(
        [&] { return std::make_unique<VisibilityTreeBuilder>(kBounds, prepass.records, prepass.rays, Settings(3)); });
    const ManyLights many;
    VisibilityBuildSettings settings = Settings(ManyLights::kLights);
    settings.lights = &many.tree;
    const auto records = std::span<const VisibilityRecord>(many.records).first(5000);
    ExpectStopsEverywhere(
        [&] { return std::make_unique<VisibilityTreeBuilder>(kBounds, records, many.rays, settings); });
}

}  // namespace
