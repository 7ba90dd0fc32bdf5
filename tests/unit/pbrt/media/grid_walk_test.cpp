#include <gtest/gtest.h>

#include "media_test_support.h"
#include "pbrt/media/medium.h"

namespace pbrt::test {
namespace {

/// A grid whose cells have different values; every third cell is empty.
MajorantGrid NumberedGrid(const glm::ivec3 &n) {
    return MajorantGrid(n, [n](const glm::ivec3 &c) {
        const int i = (c.z * n.y + c.y) * n.x + c.x;
        return i % 3 == 0 ? Float(0) : Float(i);
    });
}

/// Checks every rule of a walk. `expectedLength`: of the ray in the box, or negative if it is not known.
void CheckWalk(const MajorantGrid &grid, const AffineMap &map, const Ray &ray, Float tMax, double tolerance) {
    const glm::ivec3 n = grid.Resolution();
    GridWalk walk(grid, map, ray, tMax);
    Float begin = 0, end = 0, value = 0, last = 0;
    int count = 0;
    double sum = 0;
    while (walk.Next(&begin, &end, &value)) {
        ASSERT_LE(++count, n.x + n.y + n.z + 3);
        ASSERT_LT(begin, end);
        ASSERT_GE(begin, last);
        ASSERT_LE(end, tMax);
        last = end;
        sum += double(value) * double(end - begin);
        // Places of the stretch are in a cell of that value.
        for (Float t : {begin, (begin + end) / 2, end}) {
            const Point3 p = walk.At(t);
            const glm::dvec3 true_p = map.Point(glm::dvec3(ray.o) + double(t) * glm::dvec3(ray.d));
            EXPECT_LT(glm::length(glm::dvec3(p) - true_p), tolerance) << t;
            const glm::ivec3 cell =
                glm::clamp(glm::ivec3(glm::floor(walk.At((begin + end) / 2))), glm::ivec3(0), n - 1);
            for (int a = 0; a < 3; ++a) {
                EXPECT_GE(p[a], 0);
                EXPECT_LE(p[a], Float(n[a]));
            }
            if (t != begin && t != end && grid(cell) != value) {  // on a border both cells are right
                bool isOnBorder = false;
                for (int a = 0; a < 3; ++a) isOnBorder |= std::abs(p[a] - std::round(p[a])) < 1e-4f;
                EXPECT_TRUE(isOnBorder) << p.x << ' ' << p.y << ' ' << p.z;
            }
        }
    }
    // The integral of the values along the ray by steps.
    double reference = 0, length = 0;
    const int steps = 20000;
    const glm::dvec3 o = map.Point(glm::dvec3(ray.o)), d = map.Vector(glm::dvec3(ray.d));
    double from = 0, to = std::min<double>(tMax, 1e4);
    for (int a = 0; a < 3; ++a) {
        if (d[a] == 0) {
            if (o[a] < 0 || o[a] > n[a]) to = -1;
            continue;
        }
        const double t0 = -o[a] / d[a], t1 = (n[a] - o[a]) / d[a];
        from = std::max(from, std::min(t0, t1));
        to = std::min(to, std::max(t0, t1));
    }
    length = std::max(0.0, to - from);
    for (int i = 0; i < steps; ++i) {
        const glm::dvec3 p = o + d * (from + (i + 0.5) / steps * length);
        reference += double(grid(glm::clamp(glm::ivec3(glm::floor(p)), glm::ivec3(0), n - 1))) * length / steps;
    }
    bool runsAlongBorder = false;  // there both cells are right
    for (int a = 0; a < 3; ++a) runsAlongBorder |= std::abs(d[a]) < 1e-5 && o[a] == std::round(o[a]);
    if (!runsAlongBorder) {
        EXPECT_NEAR(sum, reference, 2e-3 * std::max(1.0, reference)) << length;
    }
}

TEST(GridWalk, RandomRaysVisitTheCellsThatTheyCross) {
    const MajorantGrid grid = NumberedGrid({7, 4, 5});
    Rng rng(3);
    for (const Transform &place : Places()) {
        const AffineMap map = AffineMap::ToBox({-1, -1, -1}, {1, 0.5, 2}, grid.Resolution()) *
                              AffineMap(glm::dmat4(place.Matrix())).Inverse();
        const Bounds3 box({-1, -1, -1}, {1, 0.5f, 2});
        for (int i = 0; i < 300; ++i) {
            const Point3 a = place.Point(PointNear(box, rng, i % 2 ? 1.f : 0.f)), b = place.Point(PointNear(box, rng));
            CheckWalk(grid, map, RayThrough(a, b), i % 3 ? Infinity : Distance(a, b), 1e-4);
        }
    }
}

TEST(GridWalk, RaysParallelToAxesOnBordersAndThroughCorners) {
    const MajorantGrid grid = NumberedGrid({4, 4, 4});
    const AffineMap identity;
    for (int a = 0; a < 3; ++a)
        for (Float sign : {-1.f, 1.f})
            for (Float u : {-1.f, 0.f, 0.5f, 1.f, 2.f, 3.25f, 4.f, 5.f})
                for (Float v : {0.f, 1.5f, 2.f, 4.f})
                    for (Float w : {-3.f, 0.f, 1.f, 2.5f, 4.f, 7.f}) {
                        Ray ray;
                        ray.o[a] = w;
                        ray.o[(a + 1) % 3] = u;
                        ray.o[(a + 2) % 3] = v;
                        ray.d = Vector3(0);
                        ray.d[a] = sign;
                        CheckWalk(grid, identity, ray, Infinity, 1e-6);
                        CheckWalk(grid, identity, ray, 2, 1e-6);
                    }
    for (const Point3 &from : {Point3(-1, -1, -1), Point3(0, 0, 0), Point3(5, 5, 5), Point3(-1, 5, -1)})
        CheckWalk(grid, identity, RayThrough(from, {2, 2, 2}), Infinity, 1e-5);
    // Grazes an edge or a corner from outside.
    for (const Point3 &to : {Point3(0, 0, 2), Point3(4, 4, 4), Point3(0, 4, 0)})
        CheckWalk(grid, identity, RayThrough(to + Vector3(-1, 1, 0), to), Infinity, 1e-5);
}

TEST(GridWalk, DirectionsNearlyParallelToAxes) {
    const MajorantGrid grid = NumberedGrid({4, 4, 4});
    for (Float tiny : {1e-45f, 1e-39f, 1e-30f, 1e-12f, 1e-6f, -1e-45f, -1e-20f})
        for (Float start : {0.f, 1.f, 1.7f, 4.f})
            CheckWalk(grid, AffineMap(), {.o = {start, -2, start}, .d = {tiny, 1, -tiny}}, Infinity, 1e-4);
}

TEST(GridWalk, FarRaysKeepTheirCells) {
    const MajorantGrid grid = NumberedGrid({4, 4, 4});
    Rng rng(8);
    for (int i = 0; i < 200; ++i) {
        const Point3 target = PointNear({{0, 0, 0}, {4, 4, 4}}, rng);
        const Point3 from = target + Float(1e5) * SampleUniformSphere(rng.Uniform2());
        GridWalk walk(grid, AffineMap(), RayThrough(from, target), Infinity);
        Float begin, end, value, last = 0;
        int count = 0;
        while (walk.Next(&begin, &end, &value)) {
            ASSERT_LE(++count, 15);
            EXPECT_LT(begin, end);
            EXPECT_GE(begin, last);
            last = end;
            const glm::ivec3 cell = glm::clamp(glm::ivec3(walk.At((begin + end) / 2)), glm::ivec3(0), glm::ivec3(3));
            EXPECT_GE(grid(cell), 0);
        }
        if (count) {
            EXPECT_LE(last, Distance(from, target) + 8);
        }
    }
}

TEST(GridWalk, WithoutAGridThereIsOneStretch) {
    for (Float tMax : {2.f, Infinity}) {
        GridWalk walk(tMax);
        Float begin, end, value;
        ASSERT_TRUE(walk.Next(&begin, &end, &value));
        EXPECT_EQ(begin, 0);
        EXPECT_EQ(end, tMax);
        EXPECT_EQ(value, 1);
        EXPECT_FALSE(walk.Next(&begin, &end, &value));
        EXPECT_TRUE(walk.Contains(1));
    }
    Float begin, end, value;
    EXPECT_FALSE(GridWalk(0).Next(&begin, &end, &value));
}

}  // namespace
}  // namespace pbrt::test
