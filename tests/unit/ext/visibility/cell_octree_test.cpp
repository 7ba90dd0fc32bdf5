#include "ext/visibility/visibility_tree.h"

#include <gtest/gtest.h>

#include <limits>

namespace ext {
namespace {

/// Quantised coordinates are in range, and a point is in the cell that its row comes from.
void ExpectInRange(const CellOctree &tree, const Point3 &p) {
    const glm::uvec3 q = tree.Quantize(p);
    for (int i = 0; i < 3; ++i) EXPECT_LT(q[i], 1u << CellOctree::MaxDepth) << p.x << " " << p.y << " " << p.z;
    EXPECT_EQ(tree.Row(p), tree.CellAt(p).row);
}

TEST(CellOctree, ThinBoxesAreNotDividedAcross) {
    constexpr Float kNaN = std::numeric_limits<Float>::quiet_NaN(), kInf = std::numeric_limits<Float>::infinity();
    for (Float thin : {0.f, 1e-45f, 1e-38f, 1e-35f, 6e-33f, 1e-30f, 1e-8f}) {
        for (Float wide : {thin, 1.f, 1e18f}) {
            const CellOctree tree(Bounds3(Point3(0), Point3(wide, wide, thin)));
            for (Float x : {-1e18f, -1.f, 0.f, thin / 2, thin, wide / 2, wide, 1e18f, kInf, -kInf, kNaN}) {
                ExpectInRange(tree, Point3(x, 0, x));
                ExpectInRange(tree, Point3(0, x, thin));
            }
            const CellOctree::Cell cell = tree.CellAt(Point3(wide / 2, wide / 2, thin / 2));
            for (int i = 0; i < 3; ++i) {
                EXPECT_TRUE(std::isfinite(cell.bounds.low[i]) && std::isfinite(cell.bounds.high[i])) << thin << wide;
            }
        }
    }
}

TEST(CellOctree, PlacesInABoxOfNormalSizeDiffer) {
    const CellOctree tree(Bounds3(Point3(0), Point3(1, 1, 1e-30f)));
    EXPECT_EQ(tree.Quantize(Point3(0.5f, 0.25f, 5e-31f)), glm::uvec3(1 << 20, 1 << 19, 1 << 20));
}

}  // namespace
}  // namespace ext
