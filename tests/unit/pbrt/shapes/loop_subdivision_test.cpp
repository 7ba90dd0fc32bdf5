#include "pbrt/shapes/mesh_sources.h"

#include <gtest/gtest.h>

#include <map>

#include "pbrt/core/error.h"
#include "shape_cases.h"

namespace pbrt::test {
namespace {

struct Control {
    std::vector<uint32_t> indices;
    std::vector<Point3> points;
    MeshData Subdivide(int levels) const { return LoopSubdivide(indices, points, levels); }
};

/// n x n squares of two triangles each, counter-clockwise about +z; every inner vertex is regular.
Control Grid(uint32_t n, Float (*height)(Float x, Float y)) {
    Control c;
    for (uint32_t y = 0; y <= n; ++y)
        for (uint32_t x = 0; x <= n; ++x) {
            auto fx = Float(x), fy = Float(y);
            c.points.push_back({fx, fy, height(fx, fy)});
        }
    for (uint32_t y = 0; y < n; ++y)
        for (uint32_t x = 0; x < n; ++x) {
            uint32_t i = y * (n + 1) + x;
            c.indices.insert(c.indices.end(), {i, i + 1, i + n + 2, i, i + n + 2, i + n + 1});
        }
    return c;
}

/// The cube of the conformance scene: valences 4 and 5, faces counter-clockwise from outside.
Control Cube() {
    return {
        {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 3, 6, 2, 3, 7, 6, 1, 2, 6, 1, 6, 5, 0, 7, 3, 0, 4, 7},
        {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}};
}

Float DistanceTo(const std::vector<Point3> &points, const Point3 &p) {
    Float nearest = Infinity;
    for (const Point3 &q : points) nearest = std::min(nearest, Distance(p, q));
    return nearest;
}

bool InnerPart(const Point3 &p, Float n) { return p.x > 2.5f && p.y > 2.5f && p.x < n - 2.5f && p.y < n - 2.5f; }

TEST(LoopSubdivision, LinesStayLinesAndPlanesStayPlanes) {
    Control c = Grid(8, [](Float x, Float y) { return 0.5f * x - 0.25f * y + 3; });
    MeshData m = c.Subdivide(2);
    for (size_t i = 0; i < m.p.size(); ++i) {
        EXPECT_NEAR(m.p[i].z, 0.5f * m.p[i].x - 0.25f * m.p[i].y + 3, 1e-5f);
        // As in stock pbrt-v4, the normal points to the side from which faces are seen clockwise.
        EXPECT_GT(Dot(Normalize(m.n[i]), Normalize(Normal3(0.5f, -0.25f, -1))), 0.9999f);
    }
}

TEST(LoopSubdivision, RegularMeshesGiveTheBoxSplineOfAParabola) {
    // The quartic box spline turns samples of x^2 on the grid into x^2 + 1/3; the 1/3 is the second moment of the limit
    // mask.
    Control c = Grid(10, [](Float x, Float) { return x * x; });
    for (int levels : {0, 1, 3}) {
        MeshData m = c.Subdivide(levels);
        EXPECT_EQ(m.indices.size(), c.indices.size() << (2 * levels));
        int inner = 0;
        for (size_t i = 0; i < m.p.size(); ++i) {
            if (!InnerPart(m.p[i], 10)) continue;
            ++inner;
            EXPECT_NEAR(m.p[i].z, Sqr(m.p[i].x) + Float(1) / 3, 2e-4f) << levels;
            Normal3 expected = Normalize(Normal3(2 * m.p[i].x, 0, -1));
            EXPECT_GT(Dot(Normalize(m.n[i]), expected), 0.99999f);
        }
        EXPECT_GT(inner, 10);
    }
}

TEST(LoopSubdivision, TheLimitDoesNotDependOnTheNumberOfLevels) {
    // Only closed surfaces are tested: on boundaries the limit mask of stock pbrt-v4 does not fit its refinement mask.
    Control c = Cube();
    MeshData coarse = c.Subdivide(1), fine = c.Subdivide(4);
    for (const Point3 &p : coarse.p) EXPECT_LT(DistanceTo(fine.p, p), 1e-5f);
}

TEST(LoopSubdivision, WarrensWeightsAtExtraordinaryVertices) {
    // Corner 0 of the cube has valence 5, corner 1 valence 4: limits computed by hand from the control points.
    Control c = Cube();
    MeshData m = c.Subdivide(0);
    ASSERT_EQ(m.p.size(), 8u);
    auto limit = [&](size_t v, std::vector<size_t> ring) {
        auto n = Float(ring.size());
        Float beta = 3 / (8 * n), gamma = 1 / (n + 3 / (8 * beta));
        Point3 p = c.points[v] * (1 - n * gamma);
        for (size_t i : ring) p += c.points[i] * gamma;
        return p;
    };
    // Points are renumbered in the order of their first use, so the expected ones are searched by position.
    for (const Point3 &expected : {limit(1, {0, 2, 5, 6}), limit(3, {0, 2, 6, 7}), limit(5, {0, 1, 4, 6})})
        EXPECT_LT(DistanceTo(m.p, expected), 1e-6f);
}

TEST(LoopSubdivision, BoundariesAreCurvesOfTheirOwn) {
    // Moving an inner point does not move the boundary.
    Control c = Grid(3, [](Float, Float) { return 0.0f; });
    MeshData flat = c.Subdivide(2);
    c.points[5].z += 4;  // (1, 1)
    MeshData bumped = c.Subdivide(2);
    std::map<std::pair<uint32_t, uint32_t>, int> faces;
    ForEachEdge(flat, [&](uint32_t a, uint32_t b) { ++faces[std::minmax(a, b)]; });
    int boundary = 0;
    for (const auto &[edge, count] : faces)
        if (count == 1) {
            ++boundary;
            EXPECT_EQ(bumped.p[edge.first].z, 0);
            EXPECT_EQ(bumped.p[edge.second].z, 0);
        }
    EXPECT_EQ(boundary, 4 * 3 * 4);
    Float highest = 0;
    for (const Point3 &p : bumped.p) highest = std::max(highest, p.z);
    EXPECT_GT(highest, 1);
}

TEST(LoopSubdivision, WhatIsNoSurfaceIsAnError) {
    std::vector<Point3> p = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {-1, 0, 0}};
    auto subdivide = [&](std::vector<uint32_t> indices) { LoopSubdivide(indices, p, 1); };
    EXPECT_NO_THROW(subdivide({0, 1, 2, 1, 0, 3}));
    EXPECT_THROW(subdivide({0, 1, 1}), UserError);
    EXPECT_THROW(subdivide({0, 1, 2, 0, 1, 3}), UserError) << "neighbouring faces have opposite orientations";
    EXPECT_THROW(subdivide({0, 1, 2, 1, 0, 3, 0, 1, 4}), UserError) << "three faces at an edge";
    EXPECT_THROW(subdivide({0, 1, 2, 0, 3, 5}), UserError) << "two fans of faces meet in one point only";
}

TEST(LoopSubdivision, UnusedPointsAreDropped) {
    std::vector<Point3> p = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    MeshData m = LoopSubdivide(std::vector<uint32_t>{1, 2, 3}, p, 1);
    EXPECT_EQ(m.p.size(), 6u);
    EXPECT_EQ(m.indices.size(), 12u);
}

}  // namespace
}  // namespace pbrt::test
