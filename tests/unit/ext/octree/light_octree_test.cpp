#include <gtest/gtest.h>

#include <map>

#include "ext/octree/light_octree.h"
#include "pbrt/math/rng.h"
#include "support/threads.h"

namespace {

using namespace ext;

/// Points crowded around a few places, like the vertices of camera paths.
std::vector<Point3> CrowdedPoints(size_t n) {
    Rng rng(17);
    std::vector<Point3> points;
    for (size_t i = 0; i < n; ++i) {
        Point3 center(rng.UniformInt(3), rng.UniformInt(2), rng.UniformInt(4));
        Point3 offset(rng.Uniform(), rng.Uniform(), rng.Uniform());
        points.push_back(center + offset * offset * Float(0.9));
    }
    return points;
}
const Bounds3 kBounds(Point3(-1, -0.5f, 0), Point3(4, 3, 6));

/// Value of group g at a point: smooth, different per group.
double ValueAt(const Point3 &p, size_t g) { return 1 + double(g) + std::abs(std::sin(double(p.x) * double(g + 1))); }

LightOctree BuildTree(const std::vector<Point3> &points, int leaves, size_t groups) {
    LightOctreeBuilder builder(kBounds, points, leaves);
    return builder.Build(groups, [&](uint32_t i, std::span<double> sum) {
        for (size_t g = 0; g < groups; ++g) sum[g] += ValueAt(points[i], g);
    });
}

TEST(LightOctree, CellsContainTheirPointsAndHoldAtMostFourNOverT) {
    std::vector<Point3> points = CrowdedPoints(20000);
    const int T = 256;
    LightOctree tree = BuildTree(points, T, 2);
    std::map<std::tuple<float, float, float, float>, size_t> perCell;
    for (const Point3 &p : points) {
        CellOctree::Cell cell = tree.Cells().CellAt(p);
        EXPECT_EQ(cell.row, tree.Row(p));
        for (int i = 0; i < 3; ++i) {
            EXPECT_GE(p[i], cell.bounds.low[i] - 1e-4f);
            EXPECT_LE(p[i], cell.bounds.high[i] + 1e-4f);
        }
        ++perCell[{cell.bounds.low.x, cell.bounds.low.y, cell.bounds.low.z, cell.bounds.high.x}];
    }
    for (const auto &[cell, count] : perCell) EXPECT_LE(count, 4 * points.size() / T);
    // The undivided grid has 64 cells; many points in few places must have split some of them.
    EXPECT_GT(tree.LeafCount(), 200u);
    EXPECT_LT(tree.LeafCount(), 2000u);
}

TEST(LightOctree, LeavesAreVisitedOnceWithTheirNumberOfPoints) {
    std::vector<Point3> points = CrowdedPoints(20000);
    LightOctreeBuilder builder(kBounds, points, 256);
    LightOctree tree = builder.Build(1, [](uint32_t, std::span<double> sum) { sum[0] += 1; });
    std::vector<uint32_t> expected(tree.Cells().NodeCount());
    for (const Point3 &p : points) ++expected[tree.Cells().CellAt(p).node];
    std::vector<uint32_t> counted = builder.PointsPerNode();
    ASSERT_EQ(counted.size(), tree.Cells().NodeCount());
    std::vector<int> visits(tree.Cells().NodeCount());
    int deepest = 0;
    tree.Cells().ForEachLeaf([&](uint32_t node, uint32_t row, int depth) {
        ++visits[node];
        deepest = std::max(deepest, depth);
        EXPECT_EQ(counted[node], expected[node]);
        EXPECT_LT(row, tree.RowCount());
    });
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), long(tree.LeafCount()));
    EXPECT_EQ(*std::max_element(visits.begin(), visits.end()), 1);
    EXPECT_EQ(deepest, tree.Depth());
}

TEST(LightOctree, LeafDistributionIsTheMeanOfItsPoints) {
    std::vector<Point3> points = CrowdedPoints(5000);
    const size_t groups = 5;
    LightOctree tree = BuildTree(points, 64, groups);
    // The reference: the average over all points of the same leaf, computed directly.
    for (size_t k = 0; k < points.size(); k += 501) {
        uint32_t row = tree.Row(points[k]);
        std::vector<double> sum(groups, 0.0);
        double total = 0;
        for (const Point3 &p : points)
            if (tree.Row(p) == row)
                for (size_t g = 0; g < groups; ++g) {
                    sum[g] += ValueAt(p, g);
                    total += ValueAt(p, g);
                }
        double before = 0;
        for (size_t g = 0; g < groups; ++g) {
            EXPECT_NEAR(double(tree.Cdf(row)[g]) - before, sum[g] / total, 1e-5);
            before = double(tree.Cdf(row)[g]);
        }
        EXPECT_EQ(tree.Cdf(row)[groups - 1], 1.f);
    }
}

TEST(LightOctree, EmptyAndDarkCellsUseAnAncestor) {
    // All points are in one octant of one top cell; those with x below its middle see no light.
    std::vector<Point3> points;
    Rng rng(3);
    for (int i = 0; i < 1000; ++i) points.push_back({0.3f * rng.Uniform(), 0.2f * rng.Uniform(), 0.4f * rng.Uniform()});
    LightOctreeBuilder builder(kBounds, points, 64);
    LightOctree tree = builder.Build(2, [&](uint32_t i, std::span<double> sum) {
        if (points[i].x > 0.15f) sum[1] += 1;
    });
    // Far away no points were recorded: there the whole scene's distribution holds, which is all on group 1.
    for (const Point3 &far : {Point3(3.9f, 2.9f, 5.9f), Point3(-100, -100, -100), Point3(1, 1, 1)}) {
        EXPECT_EQ(tree.Cdf(tree.Row(far))[0], 0.f);
        EXPECT_EQ(tree.Cdf(tree.Row(far))[1], 1.f);
    }
    EXPECT_EQ(tree.Cdf(tree.Row(points[0]))[0], 0.f);
}

TEST(LightOctree, WithoutVisibleLightProbabilitiesAreEqual) {
    std::vector<Point3> points = CrowdedPoints(500);
    LightOctreeBuilder builder(kBounds, points, 64);
    LightOctree tree = builder.Build(4, [](uint32_t, std::span<double>) {});
    std::span<const Float> cdf = tree.Cdf(tree.Row(points[0]));
    for (size_t g = 0; g < 4; ++g) EXPECT_FLOAT_EQ(cdf[g], Float(g + 1) / 4);
    LightOctreeBuilder none(kBounds, {}, 64);
    EXPECT_EQ(none.Build(1, [](uint32_t, std::span<double>) {}).LeafCount(), 64u);
}

TEST(LightOctree, CoincidentPointsEndTheSplitting) {
    std::vector<Point3> points(10000, Point3(1, 1, 1));
    LightOctree tree = BuildTree(points, 4096, 1);
    EXPECT_LE(tree.Depth(), CellOctree::MaxDepth);
    Bounds3 flat(Point3(0, 0, 0), Point3(1, 0, 1));  // a scene without thickness
    LightOctreeBuilder builder(flat, CrowdedPoints(1000), 64);
    LightOctree flatTree = builder.Build(1, [](uint32_t, std::span<double> s) { s[0] += 1; });
    EXPECT_EQ(flatTree.Cdf(flatTree.Row({0.5f, 0, 0.5f}))[0], 1.f);
}

TEST(LightOctree, ThreadsDoNotMatter) {
    std::vector<Point3> points = CrowdedPoints(20000);
    const auto build = [&] { return BuildTree(points, 512, 3); };
    EXPECT_TRUE(test::OnThreads(1, build) == test::OnThreads(4, build));
}

TEST(LightOctree, FootprintIsWithinThePapersTable2) {
    // Table 2, T = 4096: 239 KB for Lamp (2 lights, 5349 leaves), 345 KB for Hotel (9 lights, 4789 leaves).
    std::vector<Point3> points = CrowdedPoints(400000);
    LightOctree two = BuildTree(points, 4096, 2), nine = BuildTree(points, 4096, 9);
    EXPECT_GT(two.LeafCount(), 3000u);
    EXPECT_LE(double(two.Bytes()) / double(two.LeafCount()), 239e3 / 5349);
    EXPECT_LE(double(nine.Bytes()) / double(nine.LeafCount()), 345e3 / 4789);
}

}  // namespace
