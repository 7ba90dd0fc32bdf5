// Simulated experiments of several samplers. Some find a light of some room by few strong samples, others by many weak
// ones; the check must not call a sampler biased because it missed the few.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "bias_simulation.h"
#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"

namespace ext::lab {

using test::Contest, test::Fireflies, test::Lognormal;

namespace {

constexpr int kRare = 1, kCalm = 2, kOther = 3;  ///< the kinds of samplers (Contest::Sampler::kind)

bool InRoom(int x, int y) { return x >= 20 && x < 36 && y >= 24 && y < 36; }
bool InCorner(int x, int y) { return x >= 32 && x < 64 && y < 32; }
bool InSomeRooms(int x, int y) { return x / 16 % 2 == 0 && y / 12 % 2 == 0; }

/// `alarms` of `of` experiments call an honest sampler biased.
struct Alarms {
    int alarms = 0, of = 0;
};

/// `make(probability, share, spread)` gives the samplers of an experiment. Their noise is in one room, in a corner, in
/// some rooms or everywhere.
template <class F>
Alarms CountAlarms(F &&make, bool useAuxiliary) {
    std::vector<Contest> contests;
    for (auto where : {InRoom, InCorner, InSomeRooms, +[](int, int) { return true; }})
        for (int runs : {3, 12})
            for (double probability : {1e-3, 3e-3, 1e-2})
                for (double share : {0.1, 0.5})
                    for (double spread : {0.0, 1.0}) {
                        Contest contest = make(probability, share, spread);
                        contest.common.noisy = where;
                        contest.common.runs = runs;
                        contest.useAuxiliary = useAuxiliary;
                        contests.push_back(contest);
                    }
    std::atomic<int> alarms = 0;
    ParallelForEach(int64_t(contests.size()), [&](int64_t i) {
        const auto k = size_t(i);
        const std::vector<BiasVerdict> verdicts = Simulate(contests[k], 7000 + k);
        alarms += std::count(verdicts.begin(), verdicts.end(), BiasVerdict::Biased) > 0;
    });
    return {alarms, int(contests.size())};
}

/// The number of experiments of 20 that find the bias of the first sampler, which never chooses a light in a region.
int Found(Contest contest, int runs, double bias) {
    contest.common.noisy = [](int x, int y) { return x >= 16 && x < 64 && y >= 16; };
    contest.common.bias = [bias](int x, int y) { return x >= 16 && x < 64 && y >= 16 ? -bias : 0; };
    contest.common.runs = runs;
    std::atomic<int> found = 0;
    ParallelForEach(20, [&](int64_t i) { found += Simulate(contest, 99000 + uint64_t(i))[0] == BiasVerdict::Biased; });
    return found;
}

const test::Noise kSmooth = Lognormal(0.3);

/// `best` makes the reference of eight pictures, `second` the one that judges `best`.
Contest ContestOf(std::vector<Contest::Sampler> samplers, size_t best, size_t second) {
    Contest contest;
    contest.common.parts = 8;
    contest.common.partLength = 2;
    contest.samplers = std::move(samplers);
    contest.best = best;
    contest.second = second;
    return contest;
}

// Like bvh against octree: the reference that judges bvh is made of many weak samples, that of bvh, which judges
// octree, of few strong ones.
Contest TwoOfWhomOneIsRare(double probability, double share, double spread) {
    return ContestOf({{Fireflies(probability, share, 0.3, spread), kRare}, {kSmooth, kCalm}}, 1, 0);
}

// As above with a third sampler of the first kind, as bvh over meshes is one; it makes the second reference.
Contest ThreeOfWhomTwoAreRare(double probability, double share, double spread) {
    return ContestOf({{Fireflies(probability, share, 0.3, spread), kRare},
                      {Fireflies(2 * probability, share, 0.3, spread), kRare},
                      {kSmooth, kCalm}},
                     2, 1);
}

}  // namespace

// The level of 0.5 % allows one alarm. A check that uses only the runs and their reference, and half as many unseen
// samples, calls 6 to 7 % of such experiments biased.
TEST(AuxiliaryRuns, LightThatASamplerMeetsRarelyIsNoBias) {
    const Alarms two = CountAlarms(TwoOfWhomOneIsRare, true), three = CountAlarms(ThreeOfWhomTwoAreRare, true);
    EXPECT_LE(two.alarms + three.alarms, 3) << "of " << two.of + three.of;
}

// A reference from a file has no auxiliary runs that show how strong the rare samples are where the runs met none. So
// there are more false alarms than the level allows.
TEST(AuxiliaryRuns, WithoutThemSomeFalseAlarmsRemain) {
    auto make = [](double probability, double share, double spread) {
        Contest contest = TwoOfWhomOneIsRare(probability, share, spread);
        contest.second.reset();
        return contest;
    };
    const Alarms alone = CountAlarms(make, false);
    EXPECT_LE(alone.alarms, 0.035 * alone.of);
}

// The samples of other kinds of samplers do not hide the bias of a calm one. Here relL2 is 0.1, and a light is lost in
// 39 % of the picture.
TEST(AuxiliaryRuns, BiasOfACalmSamplerIsDetectedWhateverTheOthersDo) {
    for (const test::Noise &other :
         {kSmooth, Fireflies(1e-3, 0.3, 0.3), Lognormal(1.5), Fireflies(1e-2, 0.3, 0.8, 0.5)}) {
        const Contest contest = ContestOf({{kSmooth, kCalm, true}, {other, kRare}, {kSmooth, kOther}}, 2, 1);
        EXPECT_GE(Found(contest, 3, 0.03), 12);
        EXPECT_GE(Found(contest, 3, 0.05), 19);
        EXPECT_GE(Found(contest, 12, 0.03), 19);
    }
}

// If samplers of the same kind meet strong samples in the region, the difference must be larger than these can explain.
TEST(AuxiliaryRuns, OutliersInThemHideASmallBiasOnly) {
    const Contest contest =
        ContestOf({{kSmooth, kRare, true}, {Fireflies(1e-2, 0.2, 0.3), kRare}, {kSmooth, kCalm}}, 2, 1);
    EXPECT_LE(Found(contest, 3, 0.03), 4);
    EXPECT_GE(Found(contest, 12, 0.4), 18);
}

TEST(AuxiliaryRuns, OrderDoesNotMatterAndASingleImageGivesNoEstimate) {
    test::Experiment c;
    c.noise = Fireflies(1e-3, 0.3, 0.1);
    Rng rng(3, 3);
    auto render = [&](int pictures, double strength) {
        std::vector<TileMeans> list;
        for (int i = 0; i < pictures; ++i) list.push_back(Render(c, Fireflies(1e-3, strength, 0.1), 1, false, rng));
        return list;
    };
    const std::vector<TileMeans> runs = render(3, 0.01);
    BiasReference reference{render(4, 0.01), {}, 1, {}};
    const AuxiliaryRuns weak{render(3, 0.1), 1}, strong{render(3, 0.4), 1};
    const double none = CheckBias(runs, reference).visibleImage;
    const double both = CheckBias(runs, reference, {}, std::vector<AuxiliaryRuns>{weak, strong}).visibleImage;
    EXPECT_GT(both, 1.1 * none);
    EXPECT_EQ(both, CheckBias(runs, reference, {}, std::vector<AuxiliaryRuns>{strong, weak}).visibleImage);
    EXPECT_EQ(both, CheckBias(runs, reference, {}, std::vector<AuxiliaryRuns>{strong}).visibleImage);
    EXPECT_EQ(none, CheckBias(runs, reference, {}, std::vector<AuxiliaryRuns>{{render(1, 0.4), 1}}).visibleImage);
    // With twice the samples per picture, the same firefly would be twice as strong in a run.
    EXPECT_GT(CheckBias(runs, reference, {}, std::vector<AuxiliaryRuns>{{strong.pictures, 2}}).visibleImage, both);
    c.resolution = {64, 64};
    EXPECT_THROW(CheckBias(runs, reference, {}, std::vector<AuxiliaryRuns>{{render(2, 0.1), 1}}), UserError);
}

}  // namespace ext::lab
