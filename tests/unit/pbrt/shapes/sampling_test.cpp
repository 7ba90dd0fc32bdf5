#include <gtest/gtest.h>

#include "pbrt/math/frame.h"
#include "shape_cases.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

struct Receiver {
    const char *name;
    Point3 p;
    Normal3 ns;
};

std::vector<Receiver> Receivers() {
    return {{"Near", {0.3f, 0.2f, 1.1f}, Normalize(Vector3(0.1f, -0.2f, -1))},
            {"NearNoNormal", {0.3f, 0.2f, 1.1f}, Normal3(0)},
            {"Grazing", {1.2f, 0.3f, -0.4f}, Normalize(Vector3(-0.1f, 1, 0.2f))},
            {"Far", {10, 14, 20}, Normalize(Vector3(-1, -1, -1))},
            {"VeryFar", {200, -140, 300}, Normalize(Vector3(-1, 1, -1))},
            {"Inside", {0.25f, -0.05f, 0.32f}, Normalize(Vector3(1, 1, 0))},
            {"InsideNoNormal", {0.25f, -0.05f, 0.32f}, Normal3(0)},
            {"NearWall", {0.66f, -0.2f, 0.5f}, Normal3(0)}};
}

ShapeSampleContext ContextOf(const Receiver &r) {
    ShapeSampleContext c;
    c.p = r.p;
    c.n = c.ns = r.ns;
    return c;
}

struct Case {
    ShapeCase shape;
    Receiver receiver;
};

std::vector<Case> AllCases() {
    std::vector<Case> cases;
    for (const ShapeCase &s : ShapeCases())
        for (const Receiver &r : Receivers()) cases.push_back({s, r});
    // The sampling of quadrics does not depend on the normal of the receiver.
    for (const ShapeCase &s : PartCases())
        for (const Receiver &r : Receivers())
            if (std::string(r.name).find("NoNormal") == std::string::npos) cases.push_back({s, r});
    return cases;
}

constexpr int kGridX = 12, kGridY = 16;

/// The directions that can meet the shape: a cone about its bounding sphere, mapped to the unit square and cut into
/// cells.
class DirectionSquare {
  public:
    DirectionSquare(const Shape &shape, const Point3 &from) {
        Point3 center;
        Float radius;
        shape.PrimitiveBounds(0).BoundingSphere(&center, &radius);
        Float distance = Distance(from, center), s = radius * Float(1.001) / distance;
        oneMinusCos_ = s < 1 ? double(s) * double(s) / (1 + std::sqrt(1 - double(s) * double(s))) : 2;
        frame_ = Frame::FromZ(distance > 0 ? (center - from) / distance : Vector3(0, 0, 1));
    }
    size_t Cell(const Vector3 &w) const {
        double h = double(LengthSquared(w - frame_.z)) / 2;  // 1 - cos
        double phi = std::atan2(double(Dot(w, frame_.y)), double(Dot(w, frame_.x)));
        if (phi < 0) phi += 2 * double(Pi);
        return std::min(size_t(h / oneMinusCos_ * kGridX), size_t(kGridX - 1)) * kGridY +
               std::min(size_t(phi / (2 * double(Pi)) * kGridY), size_t(kGridY - 1));
    }

  private:
    double oneMinusCos_;
    Frame frame_;
};

/// Cuts the first primitive into small pieces; calls visit(point, area).
template <class Visit>
void ForEachPiece(const Shape &shape, Visit visit) {
    bool triangle = shape.Kind() == ShapeKind::TriangleMesh;
    constexpr int n = 300;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            double u = (i + 0.5) / n, v = (j + 0.5) / n, area = 1;
            if (triangle) {
                area = 2 * double(shape.Area(0)) * (1 - u);
                v *= 1 - u;
            }
            SurfacePoint s = shape.Surface(0, {0, Float(u), Float(v)});
            if (!triangle) area = double(Length(Cross(s.dpdu, s.dpdv)));
            visit(s, area / (double(n) * n));
        }
}

/// True if the shape's own surface lies between the receiver and its point p.
bool HidesItself(const Shape &shape, const ShapeSampleContext &from, const Point3 &p) {
    constexpr Float kMargin = 1e-3f;
    Float distance = Distance(from.p, p);
    return shape.Intersect(0, {from.p, (p - from.p) / distance, distance - kMargin}, 0).has_value();
}

/// The probability of each cell of the direction square, found by integrating PdfSolidAngle over the surface itself.
/// That needs neither the sampler nor intersections and has no singularity at silhouettes.
std::vector<double> CellProbabilities(const Case &c, const DirectionSquare &square) {
    std::vector<double> cells(size_t(kGridX) * kGridY);
    ShapeSampleContext from = ContextOf(c.receiver);
    const Shape &shape = *c.shape.shape;
    ForEachPiece(shape, [&](const SurfacePoint &s, double area) {
        Vector3 wi = Normalize(s.p - from.p);
        if (c.shape.drawsVisibleOnly && HidesItself(shape, from, s.p)) return;
        double pdf = double(shape.PdfSolidAngle(0, from, wi, s.p, s.n));
        cells[square.Cell(wi)] += pdf * double(AbsDot(wi, s.n)) / double(DistanceSquared(s.p, from.p)) * area;
    });
    return cells;
}

class ShapeSampling : public testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(All, ShapeSampling, testing::ValuesIn(AllCases()),
                         [](const auto &c) { return c.param.shape.name + c.param.receiver.name; });

TEST_P(ShapeSampling, PdfSolidAngleIsThePdfOfSample) {
    const Case &c = GetParam();
    ShapeSampleContext from = ContextOf(c.receiver);
    Rng rng(11);
    int drawn = 0;
    for (int i = 0; i < 2000; ++i) {
        auto s = c.shape.shape->Sample(0, from, rng.Uniform2());
        if (!s) continue;
        ++drawn;
        Vector3 wi = Normalize(s->p - from.p);
        Float pdf = c.shape.shape->PdfSolidAngle(0, from, wi, s->p, s->n);
        // The density of a point seen edge-on changes a lot if its position is rounded.
        if (AbsDot(wi, s->n) > 0.02f) {
            ASSERT_NEAR(pdf / s->pdf, 1, 4e-3) << i;
        }
    }
    EXPECT_GT(drawn, c.shape.mayDrawNothing ? 200 : 1900);
}

TEST_P(ShapeSampling, SamplesFollowThePdfAndItIntegratesToOne) {
    const Case &c = GetParam();
    ShapeSampleContext from = ContextOf(c.receiver);
    DirectionSquare square(*c.shape.shape, from.p);
    std::vector<double> expected = CellProbabilities(c, square);
    double total = 0;
    for (double v : expected) total += v;
    if (c.shape.mayDrawNothing) {
        EXPECT_LT(total, 1 + 4e-3);
        EXPECT_GT(total, 0.1);
    } else {
        EXPECT_NEAR(total, 1, 4e-3);
    }

    constexpr int kSamples = 6000;
    Rng rng(5);
    std::vector<double> observed(expected.size());
    int drawn = 0;
    for (int i = 0; i < kSamples; ++i) {
        auto s = c.shape.shape->Sample(0, from, rng.Uniform2());
        if (!s) continue;
        ++drawn;
        ++observed[square.Cell(Normalize(s->p - from.p))];
    }
    if (c.shape.mayDrawNothing) {  // one more cell for the samples that yield no point
        expected.push_back(1 - total);
        observed.push_back(kSamples - drawn);
        total = 1;
    }
    // A cell that the midpoint rule finds empty may still contain a corner of the shape.
    for (double &v : expected) v = std::max(v / total, 1e-7) * kSamples;
    EXPECT_GT(ChiSquareTest(observed, expected, 8), SidakAlpha(1e-3, AllCases().size()));
}

TEST_P(ShapeSampling, IrradianceAgreesWithAreaSampling) {
    // The light leaves the side of the surface that faces the receiver more: the side of the normal, or the other one.
    const Case &c = GetParam();
    ShapeSampleContext from = ContextOf(c.receiver);
    Normal3 ns = from.ns == Normal3(0) ? Normal3(0, 0, 1) : from.ns;
    auto radiance = [&](const ShapeSample &s, const Vector3 &wi) {
        if (c.shape.drawsVisibleOnly && HidesItself(*c.shape.shape, from, s.p)) return 0.0;
        return (1 + double(s.uv.x)) * double(AbsDot(ns, wi));
    };
    Rng rng(21);
    RunningStatistics clever, plain;
    for (int i = 0; i < 20000; ++i) {
        auto s = c.shape.shape->Sample(0, from, rng.Uniform2());
        clever.Add(s ? radiance(*s, Normalize(s->p - from.p)) / double(s->pdf) : 0);
        auto a = c.shape.shape->SampleArea(0, rng.Uniform2());
        Vector3 wi = Normalize(a->p - from.p);
        plain.Add(radiance(*a, wi) * double(AbsDot(wi, a->n)) /
                  (double(DistanceSquared(a->p, from.p)) * double(a->pdf)));
    }
    const double z = (clever.mean - plain.mean) / std::hypot(clever.StandardError(), plain.StandardError());
    // The rounding of angles in float allows a relative error of 1e-3.
    bool close = std::abs(clever.mean - plain.mean) < 1e-3 * plain.mean;
    EXPECT_TRUE(close || NormalTail(z) > SidakAlpha(1e-3, AllCases().size()))
        << clever.mean << " " << plain.mean << " z " << z;
}

class ShapeArea : public testing::TestWithParam<ShapeCase> {};
INSTANTIATE_TEST_SUITE_P(All, ShapeArea, testing::ValuesIn(WholeAndPartCases()),
                         [](const auto &c) { return c.param.name; });

TEST_P(ShapeArea, SamplesLieInBoundsAndConeAndAddUpToTheArea) {
    const Shape &shape = *GetParam().shape;
    Bounds3 b = shape.PrimitiveBounds(0);
    Vector3 margin(1e-5f);
    b.low -= margin;
    b.high += margin;
    DirectionCone cone = shape.NormalBounds(0);
    Rng rng(8);
    RunningStatistics area;
    for (int i = 0; i < 20000; ++i) {
        auto s = shape.SampleArea(0, rng.Uniform2());
        ASSERT_TRUE(s);
        ASSERT_TRUE(b.Contains(s->p));
        ASSERT_GE(Dot(s->n, cone.w), cone.cosTheta - 1e-4f);
        area.Add(1 / double(s->pdf));
    }
    // The area of curved patches is an approximation, as in stock pbrt-v4.
    double tolerance = 4.5 * area.StandardError() + (GetParam().name == "Saddle" ? 0.01 : 2e-4) * area.mean;
    EXPECT_NEAR(area.mean, double(shape.Area(0)), tolerance);
}

/// Samples that fall into a part of the surface, each with weight 1 / pdf, estimate the area of the part.
TEST_P(ShapeArea, AreaSamplesFollowTheirDensity) {
    const Shape &shape = *GetParam().shape;
    constexpr int kCells = 10, kSamples = 100000;
    auto cell = [](const Point2 &uv) {
        auto at = [](Float x) { return std::clamp(int(x * kCells), 0, kCells - 1); };
        return size_t(at(uv.x) * kCells + at(uv.y));
    };
    std::vector<double> expected(kCells * kCells), sum(expected.size()), squares(expected.size()), count(sum);
    ForEachPiece(shape, [&](const SurfacePoint &s, double area) { expected[cell(s.uv)] += area; });
    Rng rng(15);
    for (int i = 0; i < kSamples; ++i) {
        auto s = shape.SampleArea(0, rng.Uniform2());
        ASSERT_TRUE(s);
        double weight = 1 / double(s->pdf);
        size_t c = cell(s->uv);
        sum[c] += weight / kSamples;
        squares[c] += weight * weight / kSamples;
        ++count[c];
    }
    double statistic = 0;
    int cells = 0;
    for (size_t c = 0; c < sum.size(); ++c) {
        if (count[c] < 20) continue;
        ++cells;
        // The pieces of a triangle are cut along its border, so the area of a cell is known only to 1e-3.
        double variance = (squares[c] - sum[c] * sum[c]) / kSamples + Sqr(1e-3 * expected[c]);
        statistic += Sqr(sum[c] - expected[c]) / variance;
    }
    EXPECT_GT(cells, 20);
    EXPECT_GT(ChiSquareTail(statistic, cells), SidakAlpha(1e-3, WholeAndPartCases().size()));
}

TEST_P(ShapeArea, AreaSamplesLieOnTheSurface) {
    const Shape &shape = *GetParam().shape;
    Rng rng(9);
    for (int i = 0; i < 500; ++i) {
        auto s = shape.SampleArea(0, rng.Uniform2());
        auto hit = shape.Intersect(0, {s->p + s->n * 0.01f, -s->n, 0.02f}, 0);
        ASSERT_TRUE(hit) << i;
        EXPECT_NEAR(hit->t, 0.01f, 3e-6);
        SurfacePoint p = shape.Surface(0, *hit);
        EXPECT_LT(Distance(p.p, s->p), 1e-5);
        EXPECT_LT(glm::length(p.uv - s->uv), 2e-4);
        EXPECT_GT(Dot(p.n, s->n), 0.9999f);
    }
}

}  // namespace
}  // namespace pbrt::test
