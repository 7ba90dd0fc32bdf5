#include "pbrt/math/bounds.h"

#include <gtest/gtest.h>

#include "pbrt/math/frame.h"
#include "pbrt/math/rng.h"
#include "support/sampling.h"

namespace pbrt::test {
namespace {

TEST(Bounds3, EmptyIsNeutralInUnion) {
    Bounds3 empty, box({1, 2, 3}, {4, 0, 5});
    EXPECT_TRUE(empty.IsEmpty());
    EXPECT_EQ(empty.SurfaceArea(), 0);
    EXPECT_FALSE(box.IsEmpty());
    Bounds3 u = Union(empty, box);
    EXPECT_EQ(u.low, Point3(1, 0, 3));
    EXPECT_EQ(u.high, Point3(4, 2, 5));
    EXPECT_FALSE(Bounds3(Point3(1)).IsEmpty());
    Point3 c;
    Float radius = -1;
    empty.BoundingSphere(&c, &radius);
    EXPECT_EQ(radius, 0);
}

TEST(Bounds3, MeasuresOfABox) {
    Bounds3 box({0, 0, 0}, {1, 2, 3});
    EXPECT_EQ(box.SurfaceArea(), 2 * (2 + 6 + 3));
    EXPECT_EQ(box.LongestAxis(), 2);
    EXPECT_EQ(Bounds3({0, 0, 0}, {3, 2, 1}).LongestAxis(), 0);
    EXPECT_EQ(Bounds3({0, 0, 0}, {1, 2, 1}).LongestAxis(), 1);
    EXPECT_EQ(box.Center(), Point3(0.5f, 1, 1.5f));
}

TEST(Bounds3, EveryCornerIsInsideAndDistinct) {
    Bounds3 box({-1, -2, -3}, {1, 2, 3});
    Point3 center;
    Float radius;
    box.BoundingSphere(&center, &radius);
    for (int i = 0; i < 8; ++i) {
        EXPECT_TRUE(box.Contains(box.Corner(i)));
        EXPECT_NEAR(Distance(box.Corner(i), center), radius, 1e-6f);
        for (int j = 0; j < i; ++j) EXPECT_NE(box.Corner(i), box.Corner(j));
    }
    EXPECT_FALSE(box.Contains({1.0001f, 0, 0}));
}

TEST(Bounds3, UnionContainsAllItsPoints) {
    Rng rng(1);
    Bounds3 box;
    std::vector<Point3> points;
    for (int i = 0; i < 50; ++i) {
        points.push_back(RandomVector(rng));
        box = Union(box, points.back());
    }
    for (const Point3 &p : points) EXPECT_TRUE(box.Contains(p));
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_TRUE(std::any_of(points.begin(), points.end(), [&](Point3 p) { return p[axis] == box.low[axis]; }));
        EXPECT_TRUE(std::any_of(points.begin(), points.end(), [&](Point3 p) { return p[axis] == box.high[axis]; }));
    }
}

TEST(Bounds2i, IsHalfOpen) {
    Bounds2i a{{0, 0}, {4, 3}}, b{{2, 1}, {9, 9}};
    EXPECT_EQ(a.Area(), 12);
    EXPECT_TRUE(a.Contains({0, 0}));
    EXPECT_FALSE(a.Contains({4, 0}));
    Bounds2i c = Intersect(a, b);
    EXPECT_EQ(c.Area(), 4);
    EXPECT_TRUE(Intersect(a, Bounds2i{{4, 0}, {5, 5}}).IsEmpty());
    EXPECT_EQ(Intersect(a, Bounds2i{{7, 7}, {9, 9}}).Area(), 0);
    EXPECT_EQ((Bounds2i{{0, 0}, {1 << 20, 1 << 20}}.Area()), int64_t(1) << 40);
}

TEST(Bounds2, LerpReachesTheCorners) {
    Bounds2 b{{1, 2}, {3, 6}};
    EXPECT_EQ(b.Area(), 8);
    EXPECT_EQ(b.Lerp({0, 1}), Point2(1, 6));
}

Vector3 DirectionAt(const Vector3 &axis, Float angle, Float phi) {
    return Frame::FromZ(axis).FromLocal(SphericalDirection(std::sin(angle), std::cos(angle), phi));
}

TEST(DirectionCone, UnionContainsBothAndIsNoWiderThanNeeded) {
    Rng rng(2);
    for (int i = 0; i < 2000; ++i) {
        Float ta = Pi * rng.Uniform() * (i % 3 ? 0.3f : 1), tb = Pi * rng.Uniform() * (i % 2 ? 0.3f : 1);
        if (i % 5 == 0) ta = 0;
        DirectionCone a{Normalize(RandomVector(rng)), std::cos(ta)};
        DirectionCone b{i % 11 ? Normalize(RandomVector(rng)) : DirectionAt(a.w, 1e-3f, 1), std::cos(tb)};
        DirectionCone u = Union(a, b);
        Float tu = SafeACos(u.cosTheta);
        for (const DirectionCone &c : {a, b})
            for (int k = 0; k < 16; ++k) {
                Vector3 rim = DirectionAt(c.w, SafeACos(c.cosTheta), Float(k) * Pi / 8);
                EXPECT_LE(AngleBetween(Normalize(rim), u.w), tu + 2e-3f) << i;
            }
        Float needed = std::max({ta, tb, std::min(Pi, (ta + tb + AngleBetween(a.w, b.w)) / 2)});
        EXPECT_LE(tu, needed + 2e-3f) << i;
    }
}

TEST(DirectionCone, SpecialCases) {
    DirectionCone empty, a{{1, 0, 0}, 0.5f};
    EXPECT_TRUE(empty.IsEmpty());
    EXPECT_TRUE(Union(empty, empty).IsEmpty());
    EXPECT_EQ(Union(empty, a).cosTheta, 0.5f);
    EXPECT_EQ(Union(a, empty).w, a.w);
    EXPECT_EQ(Union(a, a).cosTheta, 0.5f);
    EXPECT_EQ(Union(a, DirectionCone::EntireSphere()).cosTheta, -1);
    EXPECT_EQ(Union(DirectionCone{{1, 0, 0}, 1}, DirectionCone{{-1, 0, 0}, 1}).cosTheta, -1);
    EXPECT_NEAR(Union(DirectionCone{{1, 0, 0}, 1}, DirectionCone{{0, 1, 0}, 1}).cosTheta, std::sqrt(0.5f), 1e-6f);
}

}  // namespace
}  // namespace pbrt::test
