#include "ext/visibility/cell_cut.h"

#include <gtest/gtest.h>

#include "pbrt/math/rng.h"

namespace {

using namespace ext;

/// Four clouds of 16 lamps; lamp i is in cloud i / 16.
LightTree Clouds() {
    Rng rng(7);
    std::vector<Emitter> emitters(64);
    for (uint32_t i = 0; i < emitters.size(); ++i) {
        const Point3 p = Point3(Float(i / 16) * 10, 0, 0) + Vector3(rng.Uniform(), rng.Uniform(), rng.Uniform());
        emitters[i] = {.bounds = LightBounds{.bounds = Bounds3(p, p), .phi = 1, .cosTheta_o = -1}, .intensity = 1};
    }
    return LightTree(emitters);
}

/// `each` shadow rays to every lamp, by position in the tree. `contribution(lamp)` is the contribution over the
/// unoccluded one; if it is negative, the lamp is not tested.
template <class Contribution>
std::vector<ShadowRaySums> ShadowRays(const LightTree &tree, int each, Contribution &&contribution) {
    std::vector<ShadowRaySums> sums;
    for (uint32_t position = 0; position < tree.LightCount(); ++position) {
        const double r = contribution(tree.LightAt(position)), n = each;
        if (r >= 0) sums.push_back({position, n * r * r / 8, n / 8, n / 64});
    }
    return sums;
}

CellCut Cut(const LightTree &tree, const std::vector<ShadowRaySums> &sums, const CellCut *above = nullptr,
            size_t nodes = 64) {
    double weight = 0;
    for (const ShadowRaySums &s : sums) weight += s.w;
    return CellCut(tree, sums, weight, above, {.shrinkage = 4, .nodes = nodes}, [](auto &&) {});
}

double FactorOf(const LightTree &tree, const CellCut &cut, uint32_t lamp) {
    return double(cut.Factors()[tree.FindInCut(cut.Nodes(), tree.PositionOf(lamp))]);
}

TEST(CellCut, WithoutShadowRaysAllLightsAreAlike) {
    const LightTree tree = Clouds();
    const CellCut cut = Cut(tree, {});
    for (uint32_t lamp = 0; lamp < 64; ++lamp) EXPECT_NEAR(FactorOf(tree, cut, lamp), 1, 1e-6) << lamp;
}

TEST(CellCut, NeighboursLearnFromEachOther) {
    // A third of the lamps was tried: those of cloud 2 are seen, the others are not.
    const LightTree tree = Clouds();
    const CellCut cut = Cut(tree, ShadowRays(tree, 20, [](uint32_t lamp) {
                                return lamp % 3 ? -1.0 : lamp / 16 == 2 ? 1.0 : 0.0;
                            }));
    for (uint32_t lamp = 0; lamp < 64; ++lamp) {
        EXPECT_EQ(FactorOf(tree, cut, lamp) > 0.7, lamp / 16 == 2) << lamp;
        EXPECT_EQ(FactorOf(tree, cut, lamp) < 0.3, lamp / 16 != 2) << lamp;
    }
}

TEST(CellCut, ManyShadowRaysOutweighTheNeighbours) {
    // Of cloud 0 only lamp 5 is seen; of cloud 1 all but lamp 20.
    const LightTree tree = Clouds();
    const CellCut cut = Cut(tree, ShadowRays(tree, 500, [](uint32_t lamp) {
                                return lamp == 5 || (lamp / 16 == 1 && lamp != 20) ? 1.0 : 0.0;
                            }));
    EXPECT_NEAR(FactorOf(tree, cut, 5), 1, 0.05);
    EXPECT_LT(FactorOf(tree, cut, 6), 0.1);
    EXPECT_NEAR(FactorOf(tree, cut, 21), 1, 0.05);
    EXPECT_LT(FactorOf(tree, cut, 20), 0.15);
}

TEST(CellCut, UntestedLightsTakeTheFactorsOfTheParentCell) {
    const LightTree tree = Clouds();
    const CellCut above = Cut(tree, ShadowRays(tree, 500, [](uint32_t lamp) { return lamp % 2 ? 1.0 : 0.05; }));
    // A cell without shadow rays takes the factors of the cell above. Some lamps of cloud 3 are found half as bright as
    // there: all of its lamps become half as bright, in the same proportions.
    const CellCut same = Cut(tree, {}, &above);
    const CellCut dimmer =
        Cut(tree,
            ShadowRays(tree, 500,
                       [](uint32_t lamp) {
                           return lamp / 16 < 3 ? -1.0 : lamp % 4 == 3 ? 0.5 : lamp % 4 == 2 ? 0.025 : -1.0;
                       }),
            &above);
    for (uint32_t lamp = 0; lamp < 64; ++lamp) {
        EXPECT_NEAR(FactorOf(tree, same, lamp) / FactorOf(tree, above, lamp), 1, 0.01) << lamp;
        if (lamp / 16 < 3) continue;
        EXPECT_NEAR(FactorOf(tree, dimmer, lamp) / FactorOf(tree, above, lamp), 0.5, 0.2) << lamp;
    }
}

TEST(CellCut, SpendsItsNodesWhereTheLightIs) {
    // Only cloud 1 lights the cell, and each of its lamps has a different visibility.
    const LightTree tree = Clouds();
    const std::vector<ShadowRaySums> sums =
        ShadowRays(tree, 100, [](uint32_t lamp) { return lamp / 16 == 1 ? 0.2 + 0.1 * (lamp % 16) : 0.0; });
    const CellCut cut = Cut(tree, sums, nullptr, 20);
    EXPECT_LE(cut.Nodes().size(), 20u);
    for (uint32_t lamp = 0; lamp < 64; ++lamp) {
        const LightTree::Range range = tree.At(cut.Nodes()[tree.FindInCut(cut.Nodes(), tree.PositionOf(lamp))]);
        if (lamp / 16 != 1) continue;
        EXPECT_LE(range.Size(), 2u) << lamp;
    }
}

TEST(CellCut, FewerNodesAreJoinsOfMore) {
    const LightTree tree = Clouds();
    Rng rng(3);
    const std::vector<ShadowRaySums> sums = ShadowRays(tree, 40, [&](uint32_t) { return double(rng.Uniform()); });
    CellCut finer = Cut(tree, sums, nullptr, 64);
    EXPECT_EQ(finer.Nodes().size(), 64u);
    for (size_t nodes : {33u, 12u, 5u, 1u}) {
        const CellCut coarser = Cut(tree, sums, nullptr, nodes);
        EXPECT_EQ(coarser.Nodes().size(), nodes);
        for (uint32_t node : finer.Nodes()) {
            const LightTree::Range inner = tree.At(node),
                                   outer = tree.At(coarser.Nodes()[tree.FindInCut(coarser.Nodes(), inner.begin)]);
            EXPECT_TRUE(outer.begin <= inner.begin && inner.end <= outer.end);
        }
        finer = coarser;
    }
}

TEST(CellCut, AHiddenLightGetsAtMostHalfOfTheProbability) {
    // Every record tests the hidden lamp 5, at nearly all of the weight, and one of the others.
    constexpr float kWeak = 1e-5f;
    const LightTree tree = Clouds();
    std::vector<ShadowRay> rays;
    std::vector<ShadowRaySums> sums;
    for (uint32_t position = 0; position < tree.LightCount(); ++position) {
        const uint32_t lamp = tree.LightAt(position);
        const auto weak = double(kWeak);
        sums.push_back(lamp == 5 ? ShadowRaySums{position, 0, 630, 630}
                                 : ShadowRaySums{position, 10 * weak, 10 * weak, 10 * weak * weak});
        for (int k = 0; k < (lamp == 5 ? 0 : 10); ++k) {
            rays.push_back({5, 1 - kWeak, 1 - kWeak, 0});
            rays.push_back({lamp, kWeak, kWeak, 1});
        }
    }
    const auto forEachRecord = [&](auto &&visit) {
        for (size_t i = 0; i < rays.size(); i += 2) visit(std::span<const ShadowRay>(&rays[i], 2));
    };
    const CellCut cut(tree, sums, 630, nullptr, {}, forEachRecord);
    EXPECT_LE(FactorOf(tree, cut, 5), 1.01 * double(kWeak) * FactorOf(tree, cut, 50));
}

}  // namespace
