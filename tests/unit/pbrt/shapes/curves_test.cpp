#include "pbrt/shapes/curves.h"

#include <gtest/gtest.h>

#include "support/sampling.h"

namespace pbrt::test {
namespace {

Curves::Segment SomeSegment(Rng &rng) {
    Curves::Segment s;
    Point3 at = 0.5f * RandomDirection(rng);
    Vector3 step = 0.5f * RandomDirection(rng);
    for (Point3 &p : s.curve.p) {
        p = at;
        at += step + 0.25f * RandomDirection(rng);
    }
    s.width0 = 0.02f + 0.1f * rng.Uniform();
    s.width1 = 0.02f + 0.1f * rng.Uniform();
    return s;
}

/// The reference: the strip cut into many quadrilaterals in the plane across the ray, in double precision. Widths are
/// multiplied by `factor`.
std::optional<PrimitiveHit> SlowHit(const Curves::Segment &s, Float factor, const Point3 &o, const Vector3 &d) {
    constexpr int kSteps = 400;
    using V3 = glm::dvec3;
    using V2 = glm::dvec2;
    V3 z = glm::normalize(V3(d));
    V3 x = glm::normalize(glm::cross(z, std::abs(z.x) < 0.5 ? V3(1, 0, 0) : V3(0, 1, 0))), y = glm::cross(z, x);
    struct Cut {
        V2 left, right;
        double z;
    };
    auto cut = [&](int i) {
        double u = double(i) / kSteps, w = 1 - u;
        V3 p[4];
        for (size_t k = 0; k < 4; ++k) p[k] = V3(s.curve.p[k]);
        V3 c = w * w * w * p[0] + 3 * u * w * w * p[1] + 3 * u * u * w * p[2] + u * u * u * p[3] - V3(o);
        V3 t = w * w * (p[1] - p[0]) + 2 * u * w * (p[2] - p[1]) + u * u * (p[3] - p[2]);
        V2 tangent = glm::normalize(V2(glm::dot(t, x), glm::dot(t, y))), center(glm::dot(c, x), glm::dot(c, y));
        V2 half = V2(-tangent.y, tangent.x) * (double(factor) * (w * double(s.width0) + u * double(s.width1)) / 2);
        return Cut{center + half, center - half, glm::dot(c, z)};
    };
    std::optional<PrimitiveHit> best;
    auto cross = [](V2 a, V2 b) { return a.x * b.y - a.y * b.x; };
    Cut a = cut(0);
    for (int i = 0; i < kSteps; ++i) {
        Cut b = cut(i + 1);
        V2 corners[4] = {a.left, b.left, b.right, a.right};
        int positive = 0, negative = 0;
        for (int k = 0; k < 4; ++k) {
            double c = cross(corners[k], corners[(k + 1) % 4] - corners[k]);
            positive += c > 0;
            negative += c < 0;
        }
        if ((positive == 0 || negative == 0) && a.z > 0) {
            auto t = Float(a.z / glm::length(glm::dvec3(d)));
            double left = glm::length((a.left + b.left) / 2.0), right = glm::length((a.right + b.right) / 2.0);
            if (!best || t < best->t) best = PrimitiveHit{t, (Float(i) + 0.5f) / kSteps, Float(right / (left + right))};
        }
        a = b;
    }
    return best;
}

std::optional<PrimitiveHit> AnyHit(const Curves &c, const Point3 &o, const Vector3 &d, uint32_t *primitive = nullptr) {
    std::optional<PrimitiveHit> best;
    for (uint32_t i = 0; i < c.PrimitiveCount(); ++i)
        if (auto hit = c.Intersect(i, {o, d, best ? best->t : Infinity}, 0)) {
            best = hit;
            if (primitive) *primitive = i;
        }
    return best;
}

/// A ray that passes the segment somewhere near its strip.
std::pair<Point3, Vector3> RayNear(Rng &rng, const Curves::Segment &s) {
    const Point3 target = s.curve.At(rng.Uniform() * 1.1f - 0.05f) + 0.08f * RandomDirection(rng);
    const Point3 o = 3.0f * RandomDirection(rng);
    return {o, (target - o) * (0.5f + rng.Uniform())};
}

TEST(Curves, HitsAreThoseOfTheFineStrip) {
    Rng rng(4);
    int hits = 0, rays = 0, wrong = 0;
    for (int k = 0; k < 40; ++k) {
        Curves::Segment s = SomeSegment(rng);
        Curves curves(CurveKind::Flat, {s}, {}, Transform(), false);
        for (int i = 0; i < 300; ++i) {
            const auto [o, d] = RayNear(rng, s);
            ++rays;
            auto hit = AnyHit(curves, o, d), inner = SlowHit(s, 0.9f, o, d), outer = SlowHit(s, 1.1f, o, d);
            hits += hit.has_value();
            if ((inner && !hit) || (hit && !outer)) ++wrong;
            if (!hit || !inner) continue;
            // In loops and steep views the reference may choose another sheet of the strip; such hits are few.
            auto same = SlowHit(s, 1, o, d);
            if (!same || std::abs(same->u - hit->u) > 0.03f || std::abs(same->v - hit->v) > 0.08f ||
                std::abs(same->t - hit->t) * Length(d) > 0.05f)
                ++wrong;
        }
    }
    EXPECT_GT(hits, rays / 4);
    EXPECT_LT(hits, rays * 3 / 4);
    EXPECT_LT(wrong, rays / 100) << "of " << rays;
}

TEST(Curves, PiecesTogetherAreTheSegmentAndBoundsHoldThem) {
    Rng rng(8);
    int several = 0;
    for (int k = 0; k < 30; ++k) {
        Curves::Segment s = SomeSegment(rng);
        Curves curves(CurveKind::Cylinder, {s}, {}, Transform::Rotate(30, {1, 2, 3}), false);
        several += curves.PrimitiveCount() > 1;
        for (uint32_t i = 0; i < curves.PrimitiveCount(); ++i) {
            Bounds3 b = curves.PrimitiveBounds(i);
            for (int n = 0; n < 100; ++n) {
                Point3 o = b.Center() + 3.0f * RandomDirection(rng);
                Vector3 d = b.Center() + 0.3f * RandomDirection(rng) - o;
                auto hit = curves.Intersect(i, {o, d}, 0);
                if (!hit) continue;
                Point3 p = o + d * hit->t;
                for (int a = 0; a < 3; ++a) EXPECT_TRUE(p[a] > b.low[a] - 1e-4f && p[a] < b.high[a] + 1e-4f);
                EXPECT_FALSE(curves.Intersect(i, {o, d, hit->t * 0.999f}, 0) &&
                             curves.Intersect(i, {o, d, hit->t * 0.999f}, 0)->t >= hit->t);
                EXPECT_FALSE(curves.Intersect(i, {o, d, hit->t * 1.0001f}, hit->t));
            }
        }
    }
    EXPECT_GT(several, 10);
}

TEST(Curves, DerivativesMatchDifferencesAndNormalsFollowTheKind) {
    Rng rng(9);
    for (CurveKind kind : {CurveKind::Flat, CurveKind::Cylinder, CurveKind::Ribbon}) {
        int hits = 0, wrongPlaces = 0;
        for (int k = 0; k < 20; ++k) {
            Curves::Segment s = SomeSegment(rng);
            Normal3 n0 = RandomDirection(rng), n1 = Normalize(n0 + 0.5f * RandomDirection(rng));
            std::vector<Normal3> normals;
            if (kind == CurveKind::Ribbon) normals = {n0, n1};
            Curves curves(kind, {s}, normals, Transform(), false), reversed(kind, {s}, normals, Transform(), true);
            for (int i = 0; i < 100; ++i) {
                const auto [o, d] = RayNear(rng, s);
                uint32_t primitive = 0;
                auto hit = AnyHit(curves, o, d, &primitive);
                if (!hit) continue;
                ++hits;
                SurfacePoint p = curves.SurfaceOnRay(primitive, *hit, {o, d});
                Float width = Lerp(hit->u, s.width0, s.width1);
                EXPECT_LT(Distance(p.dpdu, s.curve.Derivative(hit->u)), 1e-5f);
                EXPECT_NEAR(Dot(p.n, Normalize(p.dpdu)), 0, 1e-5f);
                EXPECT_NEAR(Dot(p.n, Normalize(p.dpdv)), 0, 1e-4f);
                EXPECT_LT(Distance(p.p, o + d * hit->t), 1e-5f);
                EXPECT_LE(Distance(p.p, s.curve.At(hit->u)), width * 0.6f);
                EXPECT_EQ(reversed.SurfaceOnRay(primitive, *hit, {o, d}).n, -p.n);
                Vector3 across = Cross(d, p.dpdu);
                if (kind == CurveKind::Ribbon) {
                    EXPECT_LE(Length(p.dpdv), width * 1.001f);
                    EXPECT_EQ(p.pError.x, p.pError.y);
                    Float angle = std::acos(Dot(n0, n1)) * hit->u;
                    Normal3 n = n0 * std::cos(angle) + Normalize(n1 - n0 * Dot(n0, n1)) * std::sin(angle);
                    EXPECT_NEAR(Length(p.dpdv), width * AbsDot(n, Normalize(d)), 1e-4f);
                    EXPECT_NEAR(Dot(Normalize(p.dpdv), n), 0, 1e-3f);
                    continue;
                }
                EXPECT_NEAR(Length(p.dpdv), width, 1e-5f);
                EXPECT_NEAR(p.pError.x, width, 1e-6f);
                // The hit point's distance from the centre line agrees with v.
                Vector3 unit = Normalize(across);
                if (std::abs(Dot(p.p - s.curve.At(hit->u), unit) - (hit->v - 0.5f) * width) > 0.08f * width)
                    ++wrongPlaces;
                Float turn = kind == CurveKind::Cylinder ? Pi * (hit->v - 0.5f) : 0;
                EXPECT_NEAR(Dot(Normalize(p.dpdv), unit), std::cos(turn), 1e-4f);
                // On a tube the normal seen from outside leans outwards with v, and it points away from the viewer, as
                // in stock pbrt-v4.
                EXPECT_NEAR(Dot(p.n, unit), std::sin(turn), 1e-4f);
                EXPECT_LE(Dot(p.n, -d), 1e-5f);
            }
        }
        EXPECT_GT(hits, 200);
        EXPECT_LE(wrongPlaces, hits / 100);  // where the curve is seen nearly along its axis
    }
}

TEST(Curves, TransformedCurvesAreHitLikeTransformedRays) {
    Rng rng(10);
    Transform mirror =
        Transform::Translate({1, 2, -1}) * Transform::Rotate(50, {1, 0, 2}) * Transform::Scale({-2, 2, 2});
    Transform stretch = Transform::Rotate(20, {0, 1, 1}) * Transform::Scale({1, 3, -0.5f});
    int hits = 0, different = 0;
    for (const Transform &t : {mirror, stretch})
        for (CurveKind kind : {CurveKind::Flat, CurveKind::Cylinder, CurveKind::Ribbon})
            for (int k = 0; k < 10; ++k) {
                Curves::Segment s = SomeSegment(rng);
                std::vector<Normal3> normals;
                if (kind == CurveKind::Ribbon) normals = {RandomDirection(rng), RandomDirection(rng)};
                Curves object(kind, {s}, normals, Transform(), false), placed(kind, {s}, normals, t, false);
                for (int i = 0; i < 100; ++i) {
                    const auto [o, d] = RayNear(rng, s);
                    uint32_t pa = 0, pb = 0;
                    auto a = AnyHit(object, o, d, &pa), b = AnyHit(placed, t.Point(o), t.Vector(d), &pb);
                    if (a.has_value() != b.has_value()) ++different;
                    if (!a || !b) continue;
                    ++hits;
                    // The curve is cut into straight parts in another frame; where the ray runs nearly along the curve,
                    // depths differ.
                    if (Distance(t.Point(o + d * a->t), t.Point(o) + t.Vector(d) * b->t) > 1e-3f) ++different;
                    if (std::abs(a->u - b->u) > 2e-3f || std::abs(a->v - b->v) > 2e-2f) {
                        ++different;
                        continue;
                    }
                    SurfacePoint x = object.SurfaceOnRay(pa, *a, {o, d}),
                                 y = placed.SurfaceOnRay(pb, *b, {t.Point(o), t.Vector(d)});
                    EXPECT_LT(Distance(t.Vector(x.dpdu), y.dpdu), 0.05f);
                    EXPECT_LT(Distance(t.Vector(x.dpdv), y.dpdv), 0.02f);
                    // Light samples depend on it, so an instance of a wide curve looks like a copy.
                    EXPECT_LT(Distance(TransformSurface(t, x).pError, y.pError), 0.01f * Length(y.pError));
                    // A mirroring transform flips the normals of its shape; the transform of the normal undoes that.
                    EXPECT_GT(Dot(Normalize(Cross(y.dpdu, y.dpdv)), y.n), 0.999f);
                }
            }
    EXPECT_GT(hits, 1000);
    EXPECT_LE(different, hits / 50);
}

TEST(Curves, AppendedCurvesAreOneShape) {
    Rng rng(11);
    Curves::Segment a = SomeSegment(rng), b = SomeSegment(rng);
    Curves one(CurveKind::Flat, {a}, {}, Transform(), false),
        two(CurveKind::Flat, {b}, {}, Transform::Scale({2, 2, 2}), false);
    uint32_t first = one.PrimitiveCount();
    ASSERT_TRUE(one.Append(two));
    ASSERT_EQ(one.PrimitiveCount(), first + two.PrimitiveCount());
    EXPECT_EQ(one.SegmentCount(), 2u);
    for (uint32_t i = 0; i < two.PrimitiveCount(); ++i) {
        EXPECT_EQ(one.PrimitiveBounds(first + i).low, two.PrimitiveBounds(i).low);
        EXPECT_EQ(one.SegmentOfPrimitive(first + i).width0, 2 * b.width0);
    }
    EXPECT_FALSE(one.Append(Curves(CurveKind::Cylinder, {a}, {}, Transform(), false)));
    EXPECT_FALSE(one.Append(Curves(CurveKind::Flat, {a}, {}, Transform(), true)));
    EXPECT_FALSE(one.Append(Curves(CurveKind::Flat, {a}, {}, Transform::Scale({1, 1, -1}), false)));
    EXPECT_FALSE(one.Append(Curves(CurveKind::Flat, {a}, {}, Transform::Scale({1, 2, 1}), false)));
    EXPECT_FALSE(one.Append(Curves(CurveKind::Flat, {a}, {}, Transform::Rotate(30, {1, 2, 3}), false)));
}

TEST(CubicBezier, SplinesOfEveryBasisGoThroughTheirOwnPoints) {
    // A uniform B-spline, evaluated by its basis functions instead of the conversion to Bezier curves.
    Rng rng(12);
    std::vector<Point3> p(8);
    for (Point3 &q : p) q = RandomDirection(rng);
    for (const auto &[points, degree, segments] : {std::array{8, 3, 5}, {8, 2, 6}, {3, 3, 0}})
        EXPECT_EQ(SegmentCount(size_t(points), degree, CurveBasis::BSpline), size_t(segments));
    for (const auto &[points, degree, segments] : {std::array{7, 3, 2}, {8, 3, 0}, {7, 2, 3}})
        EXPECT_EQ(SegmentCount(size_t(points), degree, CurveBasis::Bezier), size_t(segments));
    for (Float u : {0.0f, 0.3f, 0.8f, 1.0f})
        for (size_t i = 0; i < 2; ++i) {
            Float w = 1 - u;
            Point3 cubic = (w * w * w * p[i] + (3 * u * u * u - 6 * u * u + 4) * p[i + 1] +
                            (3 * w * w * w - 6 * w * w + 4) * p[i + 2] + u * u * u * p[i + 3]) /
                           6.0f;
            EXPECT_LT(Distance(SegmentOf(p, i, 3, CurveBasis::BSpline).At(u), cubic), 1e-6f);
            Point3 square = (w * w * p[i] + (1 + 2 * u - 2 * u * u) * p[i + 1] + u * u * p[i + 2]) / 2.0f;
            EXPECT_LT(Distance(SegmentOf(p, i, 2, CurveBasis::BSpline).At(u), square), 1e-6f);
            Point3 parabola = w * w * p[2 * i] + 2 * u * w * p[2 * i + 1] + u * u * p[2 * i + 2];
            EXPECT_LT(Distance(SegmentOf(p, i, 2, CurveBasis::Bezier).At(u), parabola), 1e-6f);
            EXPECT_LT(Distance(SegmentOf(p, i, 3, CurveBasis::Bezier).At(0), p[3 * i]), 1e-6f);
        }
    CubicBezier c = SegmentOf(p, 0, 3, CurveBasis::Bezier), part = c.Part(0.2f, 0.7f), first, second;
    EXPECT_LT(Distance(part.At(0.4f), c.At(0.4f)), 1e-6f);
    c.Halves(&first, &second);
    EXPECT_LT(Distance(first.At(0.5f), c.At(0.25f)), 1e-6f);
    EXPECT_LT(Distance(second.At(0.5f), c.At(0.75f)), 1e-6f);
    EXPECT_LT(Distance(c.Derivative(0.4f), (c.At(0.405f) - c.At(0.395f)) * 100.0f), 1e-3f);
}

}  // namespace
}  // namespace pbrt::test
