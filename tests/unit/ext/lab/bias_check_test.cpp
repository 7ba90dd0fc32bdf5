// Simulated experiments whose truth is known show how often the check gives false alarms, and which biases it finds.
#include "ext/lab/bias_check.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "bias_simulation.h"
#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"

namespace ext::lab {

using test::Experiment, test::Fireflies, test::Lognormal, test::Pareto, test::Simulate;

namespace {

struct Count {
    int clean = 0, biased = 0, unknown = 0;
};

Count Verdicts(const Experiment &experiment, int experiments, uint64_t seed, const BiasSettings &settings = {},
               bool single = false) {
    std::vector<BiasVerdict> verdicts(experiments);
    ParallelForEach(experiments, [&](int64_t i) {
        const auto k = size_t(i);
        verdicts[k] = Simulate(experiment, seed + k, settings, single).verdict;
    });
    Count count;
    for (BiasVerdict v : verdicts)
        ++(v == BiasVerdict::Clean ? count.clean : v == BiasVerdict::Biased ? count.biased : count.unknown);
    return count;
}

Experiment With(test::Noise noise, int runs = 3) {
    Experiment c;
    c.noise = std::move(noise);
    c.runs = runs;
    return c;
}

bool Overlap(const Bounds2i &a, const Bounds2i &b) {
    return a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y;
}

double InSquare(int x, int y, double value) { return x >= 16 && x < 64 && y >= 16 && y < 64 ? value : 0; }

}  // namespace

// 816 experiments without bias, with heavy-tailed noise: relL2 up to 130, infinite variance, fireflies that carry up to
// 30 % of the light. The noise is everywhere, or in a thirtieth of the picture, as where a lamp shines into its own
// shade. 1 % of the experiments would be 8.2.
TEST(BiasCheck, HeavyTailsGiveFewerThanOneFalseAlarmInHundred) {
    const std::vector<test::Noise> noises = {Lognormal(0.3),
                                             Lognormal(1.5),
                                             Lognormal(2.2),
                                             Pareto(3),
                                             Pareto(2.2),
                                             Pareto(1.5),
                                             Fireflies(3e-4, 0.05, 0.3),
                                             Fireflies(1e-3, 0.05, 0.3),
                                             Fireflies(3e-3, 0.1, 0.1),
                                             Fireflies(1e-2, 0.2, 0.1),
                                             Fireflies(1e-3, 0.3, 0.1),
                                             Pareto(1.2)};
    int alarms = 0;
    for (size_t i = 0; i < noises.size(); ++i)
        for (int runs : {2, 3, 8, 24})
            for (bool local : {false, true}) {
                Experiment c = With(noises[i], runs);
                if (local) c.noisy = [](int x, int y) { return x >= 20 && x < 36 && y >= 24 && y < 36; };
                const int experiments = runs == 3 ? 14 : runs == 24 ? 4 : 8;
                alarms += Verdicts(c, experiments, 1000 * (i + 1) + uint64_t(runs)).biased;
            }
    EXPECT_LE(alarms, 4);
}

// A bright tile has most of the noise of its region. If two runs agree there by chance, the region seems to have little
// noise.
TEST(BiasCheck, FewRunsThatAgreeInABrightTileGiveNoFalseAlarms) {
    int alarms = 0;
    for (double sigma : {0.5, 1.0, 1.5})
        for (int runs : {2, 3}) {
            Experiment c = With(Lognormal(sigma), runs);
            c.parts = c.partLength = 8;
            auto isBright = [](int x, int y) { return x % 32 < 8 && y % 32 < 8; };
            c.truth = [=](int x, int y) { return isBright(x, y) ? 8.0 : 1.0; };
            c.noisy = isBright;
            alarms += Verdicts(c, 60, 77).biased;
        }
    EXPECT_LE(alarms, 2);
}

// Fireflies in one part of the picture do not hide a bias elsewhere, where there are enough samples to see it.
TEST(BiasCheck, FirefliesInACornerHideABiasThereOnly) {
    Experiment c = With(Fireflies(1e-3, 0.3, 0.1), 24);
    c.parts = 8;
    c.noisy = [](int x, int y) { return x < 16 && y < 16; };
    c.bias = [](int x, int y) { return x >= 64 && y >= 32 ? 0.05 : 0; };
    EXPECT_GE(Verdicts(c, 10, 23).biased, 9);
    c.bias = [](int x, int y) { return x < 16 && y < 16 ? 0.05 : 0; };
    EXPECT_EQ(Verdicts(c, 10, 24).biased, 0);
}

// The p-value of one region under nearly normal noise, with few tiles and few runs. Noise that is concentrated in one
// of 16 tiles leaves few degrees of freedom.
TEST(BiasCheck, PValueOfARegionKeepsItsLevel) {
    for (bool concentrated : {false, true}) {
        Experiment c = With(Lognormal(0.1), 2);
        c.resolution = {32, 32};
        c.parts = 2;
        c.partLength = 1;
        if (concentrated) c.truth = [](int x, int y) { return x < 8 && y < 8 ? 3.0 : 0.01; };
        const int experiments = 3000;
        std::vector<double> p(experiments);
        ParallelForEach(experiments, [&](int64_t i) { p[size_t(i)] = Simulate(c, 500 + uint64_t(i)).whole.p; });
        // The expected number of p-values below 0.01 is 0.01 x 3000 = 30 +- 5.5 under normal noise; the test takes the
        // larger of two variance estimates, which makes it lower.
        EXPECT_LE(std::count_if(p.begin(), p.end(), [](double v) { return v < 0.01; }), 45);
        EXPECT_GE(std::count_if(p.begin(), p.end(), [](double v) { return v < 0.2; }), 200);
    }
}

// Neighbouring pixels share noise, and the reference is made by a sampler with rarer, stronger samples.
TEST(BiasCheck, WideFiltersAndAnotherReferenceSamplerGiveNoFalseAlarms) {
    Experiment c = With(Lognormal(0.4));
    c.filter = 0.3;
    EXPECT_LE(Verdicts(c, 50, 1).biased, 1);
    c.filter = 0;
    c.referenceNoise = Pareto(2.2);
    EXPECT_LE(Verdicts(c, 50, 2).biased, 1);
}

TEST(BiasCheck, OnePictureAsReferenceOrOneRunGivesNoFalseAlarms) {
    for (const test::Noise &noise : {Lognormal(0.3), Lognormal(1.5), Pareto(2.2)}) {
        EXPECT_LE(Verdicts(With(noise), 15, 3, {}, true).biased, 1);
        EXPECT_LE(Verdicts(With(noise, 1), 15, 4).biased, 1);
        EXPECT_LE(Verdicts(With(noise, 1), 15, 5, {}, true).biased, 1);
    }
}

// relL2 0.02 and 4 runs are what an experiment of some seconds gives.
TEST(BiasCheck, DetectsThreePercentInARegion) {
    for (double bias : {0.03, -0.03}) {
        Experiment c = With(Lognormal(0.14), 4);
        c.bias = [bias](int x, int y) { return InSquare(x, y, bias); };
        EXPECT_GE(Verdicts(c, 40, 10).biased, 39);
        const BiasReport report = Simulate(c, 99);
        // The report has the place of the bias, its sign and its size.
        EXPECT_TRUE(Overlap(report.worst.pixels, {{16, 16}, {64, 64}})) << report.text;
        // The region with the clearest sign may be wider than the biased one.
        EXPECT_GT(report.worst.difference / bias, 0.25);
        EXPECT_LT(report.worst.difference / bias, 1.3);
        EXPECT_GT(report.worstZ * bias, 0);
        EXPECT_LT(report.pValue, 0.005);
    }
}

TEST(BiasCheck, DetectsBiasOfEveryKind) {
    struct Case {
        const char *what;
        test::Noise noise;
        std::function<double(int, int)> bias;
        bool onePicture;  ///< as reference
        int experiments, found;
        uint64_t seed;
    };
    for (const Case &k :
         {Case{"0.7 % of the whole image", Lognormal(0.14), [](int, int) { return 0.007; }, false, 40, 36, 11},
          Case{"a light lost in a corner under fireflies of relL2 0.3", Fireflies(1e-3, 0.02, 0.3),
               [](int x, int y) { return x < 32 && y < 32 ? -0.4 : 0.0; }, false, 30, 27, 12},
          Case{"4 % in a square", Lognormal(0.14), [](int x, int y) { return InSquare(x, y, -0.04); }, true, 30, 27,
               13}}) {
        Experiment c = With(k.noise, 4);
        c.bias = k.bias;
        EXPECT_GE(Verdicts(c, k.experiments, k.seed, {}, k.onePicture).biased, k.found) << k.what;
    }
}

TEST(BiasCheck, IsCleanOnlyWhereBiasIsDetectable) {
    EXPECT_GE(Verdicts(With(Lognormal(0.14), 4), 40, 14).clean, 39);
    // The pictures are too noisy for a bias of 3 %: the verdict is unknown, with or without bias.
    Experiment noisy = With(Lognormal(1.2));
    EXPECT_GE(Verdicts(noisy, 20, 15).unknown, 19);
    noisy.bias = [](int x, int y) { return InSquare(x, y, 0.03); };
    EXPECT_EQ(Verdicts(noisy, 20, 16).clean, 0);
    // The same data are enough if only a bias of 60 % matters.
    BiasSettings coarse;
    coarse.interest = 0.6;
    EXPECT_GE(Verdicts(With(Lognormal(1.2)), 20, 17, coarse).clean, 15);
}

// The report states the bias that would be seen in 9 of 10 experiments; here experiments with that bias are simulated.
TEST(BiasCheck, DetectsTheBiasThatItStatesAsDetectable) {
    for (const test::Noise &noise : {Lognormal(0.3), Lognormal(0.8), Fireflies(1e-2, 0.05, 0.2)}) {
        double visible = 0;
        for (uint64_t i = 0; i < 10; ++i) visible += Simulate(With(noise), 180 + i).visibleImage / 10;
        Experiment c = With(noise);
        c.bias = [visible](int, int) { return visible; };
        EXPECT_GE(Verdicts(c, 40, 19).biased, 33) << visible;
        // The stated bias is not far too large, either: a quarter of it is mostly missed.
        c.bias = [visible](int, int) { return visible / 4; };
        EXPECT_LE(Verdicts(c, 40, 19).biased, 20) << visible;
    }
}

TEST(BiasCheck, VisibleBiasFallsWithTheNumberOfRuns) {
    double last = 1e9;
    for (int runs : {2, 4, 16}) {
        Experiment c = With(Lognormal(0.8), runs);
        c.partLength = 16;
        const double visible = Simulate(c, 20).visibleImage;
        EXPECT_LT(visible, 0.8 * last);
        last = visible;
    }
}

TEST(BiasCheck, UsesTheKnownNoiseOfTheReference) {
    Rng rng(1, 2);
    Experiment c = With(Lognormal(0.05), 6);
    std::vector<TileMeans> runs;
    for (int i = 0; i < c.runs; ++i) runs.push_back(test::Render(c, c.noise, 1, true, rng));
    // The reference is much noisier than the runs: its relL2 is exp(0.16) - 1 = 0.17.
    BiasReference reference;
    reference.parts.push_back(test::Render(c, Lognormal(0.4), 1, false, rng));
    reference.relL2 = 0.17;
    const double known = CheckBias(runs, reference).visibleImage;
    reference.relL2.reset();
    const double scattered = CheckBias(runs, reference).visibleImage;
    EXPECT_GT(known, 0.02);
    EXPECT_GT(scattered, 0.02);
    reference.relL2 = 1e-6;
    EXPECT_LT(CheckBias(runs, reference).visibleImage, 0.01);
}

TEST(BiasCheck, ReportsEveryTestItMade) {
    const BiasReport report = Simulate(With(Lognormal(0.3)), 21);
    EXPECT_EQ(report.tiles, 12 * 8);
    // At 3 runs a block has 4 x 4 tiles, so there are 3 x 2, then 2 x 1, then 1 blocks.
    EXPECT_EQ(report.tests, 6 + 2 + 1);
    EXPECT_EQ(report.smallestSide, 32);
    EXPECT_EQ(report.whole.pixels.low, Point2i(0, 0));
    EXPECT_EQ(report.whole.pixels.high, Point2i(96, 64));
    EXPECT_EQ(report.whole.level, 2);
    EXPECT_FALSE(report.text.empty());
    EXPECT_GE(report.pValue, report.worst.p);
    EXPECT_NEAR(report.meanDifference, report.whole.difference, 0.02);
}

TEST(BiasCheck, TestsEveryChannel) {
    Rng rng(4, 4);
    auto render = [&](int length, double blue) {
        Image image(PixelFormat::Float, {96, 64}, {"R", "G", "B", "A"});
        const test::Noise noise = Lognormal(0.1 / std::sqrt(length));
        ForEachValue(image, [&](Point2i p, int c) { image.Set(p, c, Float((c == 2 ? 0.02 * blue : 1) * noise(rng))); });
        return ComputeTileMeans(image);
    };
    BiasReference reference;
    std::vector<TileMeans> runs;
    for (int i = 0; i < 4; ++i) reference.parts.push_back(render(8, 1));
    for (int i = 0; i < 4; ++i) runs.push_back(render(1, 0.9));
    const BiasReport report = CheckBias(runs, reference);
    EXPECT_EQ(report.verdict, BiasVerdict::Biased);
    EXPECT_EQ(report.worst.channel, 2);
    EXPECT_NEAR(report.worst.difference, -0.1, 0.02);
    EXPECT_NEAR(report.meanDifference, -0.002 / 2.02, 0.002);
}

TEST(BiasCheck, PicturesWithoutNoiseAreJudgedByTheAllowance) {
    Experiment c;
    c.noise = [](Rng &) { return 1.0; };
    EXPECT_EQ(Simulate(c, 1).verdict, BiasVerdict::Clean);
    c.bias = [](int, int) { return 0.001; };
    EXPECT_EQ(Simulate(c, 1).verdict, BiasVerdict::Clean);
    c.bias = [](int, int) { return 0.003; };
    EXPECT_EQ(Simulate(c, 1).verdict, BiasVerdict::Biased);
    c.truth = [](int, int) { return 0.0; };
    EXPECT_EQ(Simulate(c, 1).verdict, BiasVerdict::Clean);
}

TEST(BiasCheck, ThrowsIfImagesDoNotMatch) {
    Rng rng(1, 1);
    Experiment c, other;
    other.resolution = {64, 64};
    const TileMeans a = test::Render(c, c.noise, 1, false, rng), b = test::Render(other, c.noise, 1, false, rng);
    auto of = [](const TileMeans &part) {
        BiasReference reference;
        reference.parts.push_back(part);
        return reference;
    };
    EXPECT_THROW(CheckBias({}, of(a)), UserError);
    EXPECT_THROW(CheckBias(std::vector<TileMeans>{a}, {}), UserError);
    EXPECT_THROW(CheckBias(std::vector<TileMeans>{a, b}, of(a)), UserError);
    EXPECT_THROW(CheckBias(std::vector<TileMeans>{a}, of(b)), UserError);
}

}  // namespace ext::lab
