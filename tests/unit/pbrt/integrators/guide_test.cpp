// What guides bounces: densities against samples, and what is learned from records that are known.
#include <gtest/gtest.h>

#include "pbrt/core/state_io.h"
#include "pbrt/integrators/guided_bounces.h"
#include "support/build_text.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

Vector3 Uniform(Rng &rng) { return EqualAreaSquareToSphere({rng.Uniform(), rng.Uniform()}); }

GuideGrid SomeGrid(Rng &rng) {
    GuideGrid grid;
    for (Float &cell : grid.cell) cell = rng.Uniform() < 0.3f ? 0 : rng.Uniform();
    return grid;
}

TEST(GuideDirections, SamplesHaveTheirDensityAndItIntegratesToOne) {
    Rng rng(7);
    constexpr int kFine = 64, kSamples = 200000;
    for (const bool bothSides : {false, true})
        for (int run = 0; run < 6; ++run) {
            GuideDirections directions;
            const Vector3 n = Uniform(rng);
            directions.Prepare(SomeGrid(rng), n, bothSides);
            ASSERT_TRUE(directions.IsUsable());
            std::vector<double> expected(kFine * kFine), observed(kFine * kFine);
            double sum = 0;
            for (size_t i = 0; i < expected.size(); ++i) {
                const Point2 middle((static_cast<Float>(i % kFine) + 0.5f) / kFine,
                                    (static_cast<Float>(i / kFine) + 0.5f) / kFine);
                const double share = static_cast<double>(directions.Pdf(EqualAreaSquareToSphere(middle))) * 4 *
                                     static_cast<double>(Pi) / (kFine * kFine);
                expected[i] = share * kSamples;
                sum += share;
            }
            EXPECT_NEAR(sum, 1, 1e-4);
            int borders = 0;
            for (int k = 0; k < kSamples; ++k) {
                Float pdf = 0;
                const Vector3 w = directions.Sample({rng.Uniform(), rng.Uniform()}, &pdf);
                EXPECT_GT(pdf, 0);
                borders += pdf != directions.Pdf(w);
                const Point2 p = EqualAreaSphereToSquare(w) * Float(kFine);
                const auto at = [](Float x) {
                    return static_cast<size_t>(std::clamp(static_cast<int>(x), 0, kFine - 1));
                };
                ++observed[at(p.y) * kFine + at(p.x)];
            }
            EXPECT_LE(borders, 4) << "only rounding at borders of cells may choose another cell";
            // The few samples that rounding put into a cell without density are left out.
            for (size_t i = 0; i < observed.size(); ++i)
                if (expected[i] == 0 && observed[i] <= 2) observed[i] = 0;
            EXPECT_GT(ChiSquareTest(observed, expected), 1e-4) << run;
        }
}

GuideParams Directions() {
    GuideParams params;
    params.roulette = false;
    params.directions = true;
    params.records = 1 << 20;
    return params;
}

/// A guide that has learned from made-up records at p in [-1, 1]^2 on the plane z = 0: the light of a record in
/// direction w is light(p, w).
template <class Light>
class Learned {
  public:
    Learned(const Light &light, bool isGlossy, bool bothSides = false)
        : built_(BuildText("Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 100\n"
                           "Sampler \"independent\" \"integer pixelsamples\" 4\nWorldBegin\n"
                           "LightSource \"infinite\" Shape \"sphere\"\n")),
          guide(Directions(), nullptr) {
        PrepareContext context = built_.Preparation(progress_);
        context.samplesPerPixel = 4;
        guide.Prepare(context, 1);
        EXPECT_EQ(guide.NextLearning(), 2);
        Rng rng(3);
        for (int sample = 0; sample < 2; ++sample)
            for (int y = 0; y < 100; ++y)
                for (int x = 0; x < 100; ++x) {
                    LightLearner::PathPlaces places = guide.BeginRecords(guide.PathNumber({x, y}, sample));
                    GuideRecord r;
                    r.p = {2 * rng.Uniform() - 1, 2 * rng.Uniform() - 1, 0};
                    r.normal = {0, 0, 1};
                    r.wi = SampleCosineHemisphere({rng.Uniform(), rng.Uniform()});
                    r.pdf = r.bsdfPdf = r.wi.z / Pi;
                    if (bothSides && rng.Uniform() < 0.5f) r.wi.z = -r.wi.z;
                    if (bothSides) r.pdf = r.bsdfPdf = r.pdf / 2;
                    r.radiance = r.added = light(r.p, r.wi);
                    r.isGlossy = isGlossy;
                    r.bothSides = bothSides;
                    if (r.radiance > 0) guide.Record(places, r);
                }
        guide.Learn(progress_);
        EXPECT_EQ(guide.NextLearning(), 0);
    }

  private:
    Progress progress_;
    BuiltScene built_;

  public:
    PathGuide guide;
};

Float Lobe(const Point3 &, const Vector3 &w) { return Dot(w, Normalize(Vector3(1, 0.3f, 1))) > 0.9f ? 10.f : 0.1f; }

TEST(PathGuide, HasNoShareUnderEvenLight) {
    Learned even([](const Point3 &, const Vector3 &) { return 1.f; }, false);
    Float share = 0;
    EXPECT_EQ(even.guide.At({0, 0, 0}, false, &share), nullptr);
}

TEST(PathGuide, LearnsWhereLightComesFrom) {
    Learned lobe(Lobe, false);
    Float share = 0;
    const GuideGrid *grid = lobe.guide.At({0.2f, 0.1f, 0}, false, &share);
    ASSERT_TRUE(grid);
    EXPECT_GT(share, 0.2f);
    EXPECT_LE(share, 0.7f);
    GuideDirections directions;
    directions.Prepare(*grid, {0, 0, 1}, false);
    EXPECT_GT(directions.Pdf(Normalize(Vector3(1, 0.3f, 1))), 4 * directions.Pdf(Normalize(Vector3(-1, 0, 1))));
    // Nothing was learned of glossy surfaces.
    EXPECT_EQ(lobe.guide.At({0.2f, 0.1f, 0}, true, &share), nullptr);
}

TEST(PathGuide, GuidesOnlyWhereLightComesFromOneSide) {
    Learned half([](const Point3 &p, const Vector3 &w) { return p.x > 0 ? Lobe(p, w) : 1.f; }, false);
    Float share = 0;
    EXPECT_NE(half.guide.At({0.5f, 0.1f, 0}, false, &share), nullptr);
    EXPECT_EQ(half.guide.At({-0.5f, 0.1f, 0}, false, &share), nullptr);
}

TEST(PathGuide, ASavedStateIsLoadedBitByBitAndADamagedOneRefused) {
    Learned lobe(Lobe, false);
    StateWriter saved;
    lobe.guide.Save(saved);
    const std::string state = saved.Joined();
    BuiltScene built = BuildText("WorldBegin LightSource \"infinite\" Shape \"sphere\"\n");
    Progress progress;
    const auto load = [&](const std::string &bytes, PathGuide &guide) {
        StateReader reader(bytes, "state");
        PrepareContext context = built.Preparation(progress);
        context.pixelBounds = {{0, 0}, {100, 100}};
        context.samplesPerPixel = 4;
        context.learned = &reader;
        guide.Prepare(context, 1);
    };
    PathGuide other(Directions(), nullptr);
    load(state, other);
    StateWriter again;
    other.Save(again);
    EXPECT_EQ(again.Joined(), state);
    for (const std::string &damaged :
         {state.substr(0, state.size() - 1), state.substr(0, 20), std::string(state.size(), '\x7f')}) {
        PathGuide refusing(Directions(), nullptr);
        EXPECT_THROW(load(damaged, refusing), UserError);
    }
}

/// The mean of f cos L / density over guided bounces, where L is the light that was learned, is that over the BSDF's
/// own bounces; it is not if the density leaves the guide out, or has it with another share.
void CheckMean(const Bsdf &bsdf, bool isGlossy, bool bothSides) {
    Learned lobe(Lobe, isGlossy, bothSides);
    PathVertex vertex;
    vertex.point.p = {0.2f, 0.1f, 0};
    vertex.point.wo = Normalize(Vector3(-1, 0.2f, 1));
    vertex.point.n = vertex.point.shading.n = {0, 0, 1};
    vertex.bsdf = bsdf;
    GuidedBounces bounces(lobe.guide, {0, 0}, 5);
    bounces.Begin(vertex);
    Float share = 0;
    ASSERT_TRUE(lobe.guide.At(vertex.point.p, isGlossy, &share));
    Rng rng(11);
    RunningStatistics own, guided, withoutGuide, wrongShare;
    const auto weightOf = [&](const BsdfSample &s, Float pdf) {
        return static_cast<double>(s.f.Average() * std::abs(s.wi.z) / pdf * Lobe(vertex.point.p, s.wi));
    };
    for (int i = 0; i < 400000; ++i) {
        const std::optional<BsdfSample> a =
            vertex.bsdf.Sample(vertex.point.wo, rng.Uniform(), {rng.Uniform(), rng.Uniform()});
        own.Add(a ? weightOf(*a, a->pdf) : 0);
        const std::optional<BsdfSample> b = bounces.Sample(vertex, rng.Uniform(), {rng.Uniform(), rng.Uniform()});
        guided.Add(b ? weightOf(*b, b->pdf) : 0);
        const Float bsdfPdf = b ? vertex.bsdf.Pdf(vertex.point.wo, b->wi) : 0;
        const Float guidePdf = b ? (b->pdf - (1 - share) * bsdfPdf) / share : 0;
        withoutGuide.Add(b && bsdfPdf > 0 ? weightOf(*b, bsdfPdf) : 0);
        wrongShare.Add(b ? weightOf(*b, (1.05f - share) * bsdfPdf + (share - 0.05f) * guidePdf) : 0);
        if (b) {
            EXPECT_NEAR(bounces.Pdf(vertex, b->wi), b->pdf, 1e-3f * b->pdf + 1e-5f);
        }
    }
    const auto zTo = [&](const RunningStatistics &s) {
        return (s.mean - own.mean) / std::hypot(s.StandardError(), own.StandardError());
    };
    EXPECT_LT(std::abs(zTo(guided)), 4) << guided.mean << " " << own.mean;
    EXPECT_GT(std::abs(zTo(withoutGuide)), 6) << withoutGuide.mean;
    EXPECT_GT(std::abs(zTo(wrongShare)), 6) << wrongShare.mean;
    EXPECT_LT(guided.Variance(), own.Variance());
}

TEST(GuidedBounces, HaveTheMeanOfTheBsdfsOwnBounces) {
    const auto bsdf = [](const auto &lobe) { return Bsdf({0, 0, 1}, {1, 0, 0}, lobe); };
    CheckMean(bsdf(DiffuseBxdf(SampledSpectrum(0.7f))), false, false);
    CheckMean(bsdf(DiffuseTransmissionBxdf(SampledSpectrum(0.4f), SampledSpectrum(0.3f))), false, true);
}

TEST(GuidedBounces, LeaveSpecularSurfacesAlone) {
    EXPECT_FALSE(PathGuide::Guides(Bsdf({0, 0, 1}, {1, 0, 0}, ThinDielectricBxdf(1.5f))));
    EXPECT_TRUE(PathGuide::Guides(Bsdf({0, 0, 1}, {1, 0, 0}, DiffuseBxdf(SampledSpectrum(0.5f)))));
}

}  // namespace
}  // namespace pbrt::test
