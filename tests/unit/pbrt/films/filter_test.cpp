#include "pbrt/films/filter.h"

#include "pbrt/math/rng.h"
#include "support/errors.h"
#include "support/given_params.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

using Values = std::vector<std::pair<std::string, Float>>;

struct FilterSetup {
    std::string type;
    Values values;
    std::string name;
};

std::unique_ptr<Filter> MakeFilter(const std::string &type, const Values &values = {}) {
    DiagnosticSink sink;
    Params params;
    for (const auto &[name, value] : values) params.Number(name, value);
    return Filters().Make(type, params, FilterContext{sink});
}

class FilterTest : public ::testing::TestWithParam<FilterSetup> {
  protected:
    FilterTest() : filter_(MakeFilter(GetParam().type, GetParam().values)) {}
    /// Calls f(position, area) for a fine grid over the support.
    template <class F>
    void ForGrid(int n, F f) const {
        Vector2 r = filter_->Radius();
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                Point2 t((Float(x) + Float(0.5)) / Float(n), (Float(y) + Float(0.5)) / Float(n));
                f((t * Float(2) - Point2(1, 1)) * r, 4 * double(r.x) * double(r.y) / (double(n) * double(n)));
            }
    }
    std::unique_ptr<Filter> filter_;
};

TEST_P(FilterTest, IntegralAndPdfAreThoseOfEvaluate) {
    double integral = 0, magnitude = 0, mass = 0, difference = 0;
    ForGrid(480, [&](Point2 p, double area) {
        integral += double(filter_->Evaluate(p)) * area;
        magnitude += std::abs(double(filter_->Evaluate(p))) * area;
        mass += double(filter_->Pdf(p)) * area;
    });
    EXPECT_NEAR(double(filter_->Integral()) / integral, 1, 3e-3);
    EXPECT_NEAR(mass, 1, 2e-3);
    ForGrid(480, [&](Point2 p, double area) {
        difference += std::abs(std::abs(double(filter_->Evaluate(p))) / magnitude - double(filter_->Pdf(p))) * area;
    });
    EXPECT_LT(difference, 0.06);  // the table has 16 cells per pixel
}

TEST_P(FilterTest, FrequenciesMatchPdf) {
    constexpr int kBins = 12, kDraws = 60000;
    std::vector<double> observed(kBins * kBins, 0), expected(kBins * kBins, 0);
    Vector2 r = filter_->Radius();
    auto bin = [&](const Point2 &p) {
        const Point2i at =
            glm::clamp(Point2i((p / r + Float(1)) / Float(2) * Float(kBins)), Point2i(0), Point2i(kBins - 1));
        return at.y * kBins + at.x;
    };
    // Only a grid that both the table's cells and the bins divide would be exact; a fine grid comes close enough.
    ForGrid(1200, [&](Point2 p, double area) { expected[bin(p)] += kDraws * double(filter_->Pdf(p)) * area; });
    Rng rng(17);
    for (int i = 0; i < kDraws; ++i) {
        Point2 p = filter_->Sample(rng.Uniform2()).offset;
        ASSERT_LE(std::abs(p.x), r.x);
        ASSERT_LE(std::abs(p.y), r.y);
        observed[bin(p)] += 1;
    }
    double total = 0;
    for (double e : expected) total += e;
    for (double &e : expected) e *= kDraws / total;
    EXPECT_GT(ChiSquareTest(observed, expected), 1e-4);
}

TEST_P(FilterTest, WeightsReproduceTheFilter) {
    // Expects E[w] = 1 and E[w g] = integral of f g / integral of f, for a function g without symmetry.
    auto g = [](const Point2 &p) {
        return 1 + 0.7 * std::sin(1.3 * double(p.x) + 0.4) * std::cos(0.9 * double(p.y) - 0.8) + 0.2 * double(p.x);
    };
    double fg = 0, f = 0;
    ForGrid(500, [&](Point2 p, double area) {
        fg += double(filter_->Evaluate(p)) * g(p) * area;
        f += double(filter_->Evaluate(p)) * area;
    });
    constexpr int kStrata = 400;
    Rng rng(23);
    double mean = 0, weights = 0;
    for (int y = 0; y < kStrata; ++y)
        for (int x = 0; x < kStrata; ++x) {
            Point2 u = (Point2(Float(x), Float(y)) + rng.Uniform2()) / Float(kStrata);
            FilterSample s = filter_->Sample(glm::min(u, Point2(OneMinusEpsilon)));
            mean += double(s.weight) * g(s.offset) / (kStrata * kStrata);
            weights += double(s.weight) / (kStrata * kStrata);
        }
    EXPECT_NEAR(weights, 1, 3e-3);
    EXPECT_NEAR(mean, fg / f, 4e-3);
}

TEST_P(FilterTest, WeightIsSignedMagnitudeOverDensity) {
    // For each sample, |w| pdf integral is |f| of its table cell, which is close to |f| at the sample; the signs agree.
    Rng rng(29);
    int wrongSigns = 0;
    double difference = 0, magnitude = 0;
    for (int i = 0; i < 5000; ++i) {
        FilterSample s = filter_->Sample(rng.Uniform2());
        Float f = filter_->Evaluate(s.offset), tabulated = s.weight * filter_->Pdf(s.offset) * filter_->Integral();
        wrongSigns += f * tabulated < 0;
        difference += std::abs(double(f) - double(tabulated));
        magnitude += std::abs(double(f));
    }
    EXPECT_LT(wrongSigns, 100);
    EXPECT_LT(difference / magnitude, 0.08);
}

TEST_P(FilterTest, ZeroOutsideTheRadius) {
    Vector2 r = filter_->Radius();
    for (const Point2 &p : {Point2(r.x * 1.01f, 0), Point2(0, -r.y * 1.01f)}) {
        EXPECT_EQ(filter_->Evaluate(p), 0.0f);
        EXPECT_EQ(filter_->Pdf(p), 0.0f);
    }
}

// All filters with their defaults, and with the radii of the conformance scenes.
INSTANTIATE_TEST_SUITE_P(All, FilterTest,
                         ::testing::ValuesIn(std::vector<FilterSetup>{
                             {"box", {}, "box"},
                             {"box", {{"xradius", 1.3f}, {"yradius", 0.8f}}, "box_wide"},
                             {"gaussian", {}, "gaussian"},
                             {"gaussian", {{"xradius", 2.2f}, {"yradius", 1.6f}, {"sigma", 0.8f}}, "gaussian_wide"},
                             {"mitchell", {}, "mitchell"},
                             {"mitchell", {{"xradius", 2.5f}, {"B", 0.2f}, {"C", 0.5f}}, "mitchell_sharp"},
                             {"sinc", {}, "sinc"},
                             {"sinc", {{"xradius", 3}, {"yradius", 3.5f}, {"tau", 2.5f}}, "sinc_narrow"},
                             {"triangle", {}, "triangle"},
                             {"triangle", {{"xradius", 1.5f}, {"yradius", 2.4f}}, "triangle_tall"}}),
                         [](const auto &setup) { return setup.param.name; });

TEST(Filter, PositiveFiltersHaveUnitWeights) {
    Rng rng(31);
    for (const char *type : {"box", "gaussian", "triangle"}) {
        std::unique_ptr<Filter> filter = MakeFilter(type);
        for (int i = 0; i < 1000; ++i) EXPECT_NEAR(filter->Sample(rng.Uniform2()).weight, 1, 1e-6) << type;
    }
}

TEST(Filter, DefaultRadiiAreThoseOfTheFormat) {
    EXPECT_EQ(MakeFilter("box")->Radius(), Vector2(0.5f, 0.5f));
    EXPECT_EQ(MakeFilter("gaussian")->Radius(), Vector2(1.5f, 1.5f));
    EXPECT_EQ(MakeFilter("mitchell")->Radius(), Vector2(2, 2));
    EXPECT_EQ(MakeFilter("sinc")->Radius(), Vector2(4, 4));
    EXPECT_EQ(MakeFilter("triangle")->Radius(), Vector2(2, 2));
}

TEST(Filter, KnownValues) {
    // Mitchell-Netravali with B = C = 1/3: 8/9 at the centre of each axis, 1/18 at half the radius.
    std::unique_ptr<Filter> mitchell = MakeFilter("mitchell");
    EXPECT_NEAR(mitchell->Evaluate({0, 0}), 64.0 / 81, 1e-5);
    EXPECT_NEAR(mitchell->Evaluate({1, 0}), 8.0 / 9 / 18, 1e-5);
    EXPECT_LT(mitchell->Evaluate({1.5f, 0}), 0.0f);
    std::unique_ptr<Filter> sinc = MakeFilter("sinc");
    EXPECT_NEAR(sinc->Evaluate({0, 0}), 1, 1e-6);
    EXPECT_NEAR(sinc->Evaluate({1, 0}), 0, 1e-6);
    EXPECT_NEAR(sinc->Evaluate({0.5f, 0}), 0.6366198 * 0.9549297, 1e-5);
    // Narrower than a cell of the table.
    EXPECT_NEAR(MakeFilter("gaussian", {{"sigma", 0.01f}})->Integral(), 1, 1e-3);
    EXPECT_NEAR(double(MakeFilter("mitchell", {{"xradius", 0.02f}, {"yradius", 0.02f}})->Integral()) * 1e4, 1, 1e-3);
}

TEST(Filter, BadParametersAreErrors) {
    EXPECT_THROW(MakeFilter("gauss"), UserError);
    EXPECT_THROW(MakeFilter("box", {{"xradius", 0.0f}}), UserError);
    EXPECT_THROW(MakeFilter("gaussian", {{"sigma", -1.0f}}), UserError);
    // So narrow that all nodes of the table are 0.
    EXPECT_THROW(MakeFilter("gaussian", {{"sigma", 1e-3f}}), UserError);
}

TEST(Filter, NumbersOutsideTheirRangesAreErrors) {
    const std::vector<FilterSetup> bad = {{"box", {{"yradius", 1e38f}}, "yradius"},
                                          {"triangle", {{"xradius", 1001}}, "xradius"},
                                          {"gaussian", {{"xradius", 1e9f}}, "xradius"},
                                          {"gaussian", {{"sigma", 1e30f}}, "sigma"},
                                          {"mitchell", {{"B", 1e30f}}, "B"},
                                          {"mitchell", {{"C", -1e30f}}, "C"},
                                          {"sinc", {{"tau", 1e30f}}, "tau"}};
    for (const FilterSetup &s : bad)
        ExpectError([&] { MakeFilter(s.type, s.values); }, {"\"" + s.name + "\"", "at most"});
    EXPECT_TRUE(MakeFilter("gaussian", {{"xradius", 1000}, {"yradius", 1000}, {"sigma", 300}}));
}

}  // namespace
}  // namespace pbrt::test
