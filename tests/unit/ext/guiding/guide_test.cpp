// What guides bounces: densities against samples, and what is learned from records that are known.
#include <gtest/gtest.h>

#include "ext/guiding/guided_directions.h"
#include "pbrt/core/state_io.h"
#include "support/build_text.h"
#include "support/errors.h"
#include "support/scene_text.h"
#include "support/statistics.h"
#include "support/structure.h"

namespace pbrt::test {
using namespace ext;
namespace {

Vector3 Uniform(Rng &rng) { return EqualAreaSquareToSphere(rng.Uniform2()); }

std::vector<SourceCluster> SomeClusters(Rng &rng) {
    std::vector<SourceCluster> targets(1 + size_t(rng.Uniform() * 12));
    for (SourceCluster &target : targets) {
        for (int axis = 0; axis < 3; ++axis) target.p[axis] = 4 * rng.Uniform() - 2;
        target.r2 = Sqr(rng.Uniform() < 0.3f ? Float(0.01) : rng.Uniform());
        target.radiance = rng.Uniform();
    }
    return targets;
}

/// From where all balls are seen.
GuideDirections DirectionsTo(std::span<const SourceCluster> targets, const Point3 &p, const Vector3 &n,
                             bool bothSides) {
    PerSourceCluster radiances{};
    for (size_t k = 0; k < targets.size(); ++k) radiances[k] = targets[k].radiance;
    GuideDirections directions;
    directions.Prepare(SourceClusters(targets), radiances, p, n, bothSides);
    return directions;
}

TEST(GuideDirections, SamplesHaveTheirDensityAndItIntegratesToOne) {
    Rng rng(7);
    constexpr size_t kFine = 24, kSub = 24;
    constexpr int kSamples = 100000;
    int usable = 0;
    for (const bool bothSides : {false, true})
        for (int run = 0; run < 8; ++run) {
            const Vector3 n = Uniform(rng);
            const GuideDirections directions = DirectionsTo(SomeClusters(rng), {0.2f, -0.1f, 0.3f}, n, bothSides);
            if (!directions.IsUsable()) continue;
            ++usable;
            std::vector<double> expected(kFine * kFine), observed(kFine * kFine);
            double sum = 0;
            for (size_t y = 0; y < kFine * kSub; ++y)
                for (size_t x = 0; x < kFine * kSub; ++x) {
                    const Point2 middle((Float(x) + 0.5f) / (kFine * kSub), (Float(y) + 0.5f) / (kFine * kSub));
                    const double share = double(directions.Pdf(EqualAreaSquareToSphere(middle))) * 4 *
                                         std::numbers::pi / (kFine * kSub * kFine * kSub);
                    expected[y / kSub * kFine + x / kSub] += share * kSamples;
                    sum += share;
                }
            EXPECT_NEAR(sum, 1, 0.02) << "the borders of cones do not follow the cells";
            int outside = 0;
            for (int k = 0; k < kSamples; ++k) {
                const Vector3 w = directions.Sample(rng.Uniform2());
                EXPECT_NEAR(Length(w), 1, 1e-5f);
                outside += !(directions.Pdf(w) > 0);
                const Point2 p = EqualAreaSphereToSquare(w) * Float(kFine);
                const auto at = [](Float x) { return std::min(size_t(x), kFine - 1); };
                ++observed[at(p.y) * kFine + at(p.x)];
            }
            EXPECT_LE(outside, kSamples / 2000) << "only rounding may put a sample outside of its cone";
            double distance = 0;
            for (size_t i = 0; i < observed.size(); ++i) distance += std::abs(observed[i] - expected[i]);
            // By chance up to 6 %, where all cells are hit, and as much at the borders of cones.
            EXPECT_LT(distance / kSamples, 0.1) << run;
        }
    EXPECT_GE(usable, 8);
}

/// In a room whose walls shine dimly, two small lamps that some bounces hit.
TEST(SourceClusters, AreWhereLightComesFrom) {
    Rng rng(9);
    const Point3 lamps[] = {{1, 0.5f, 2}, {-1, 0, 1.5f}};
    constexpr Float kRadius = 0.1f;
    std::vector<RadianceSample> finds;
    std::vector<Point3> places;
    for (int i = 0; i < 40000; ++i) {
        const Point3 from(4 * rng.Uniform() - 2, 4 * rng.Uniform() - 2, 0);
        const Vector3 w = SampleUniformHemisphere(rng.Uniform2());
        places.push_back(from);
        RadianceSample find{from + w * (3 / std::max(w.z, Float(0.3))), 0.05, 2 * std::numbers::pi};
        for (const Point3 &lamp : lamps) {
            const Float along = Dot(lamp - from, w);
            if (along > 0 && Distance(from + w * along, lamp) < kRadius) {
                find.target = from + w * along;
                find.radiance = 40;
            }
        }
        // Most of what shines dimly is found to be black.
        if (find.radiance < 1) find.radiance = rng.Uniform() < 0.05f ? 1 : 0;
        finds.push_back(find);
    }
    const std::vector<SourceCluster> all = MakeSourceClusters(finds, places, places.size());
    for (const RadianceSample &find : finds) {
        EXPECT_EQ(find.cluster != RadianceSample::kNone, find.radiance > 0);
        if (find.cluster != RadianceSample::kNone) {
            ASSERT_LT(find.cluster, all.size());
        }
    }
    for (const Point3 &p : {Point3(0, 0, 0), Point3(1.5f, -1.5f, 0)}) {
        const GuideDirections directions = DirectionsTo(all, p, {0, 0, 1}, false);
        ASSERT_TRUE(directions.IsUsable());
        double toLamps = 0;
        for (const Point3 &lamp : lamps) {
            const Float sine2 = Sqr(kRadius) / LengthSquared(lamp - p);
            const Frame frame = Frame::FromZ(Normalize(lamp - p));
            constexpr int kDirections = 256;
            for (int i = 0; i < kDirections; ++i) {
                const Point2 onDisk = SampleUniformDiskConcentric(rng.Uniform2()) * std::sqrt(sine2);
                const Vector3 w(onDisk.x, onDisk.y, std::sqrt(1 - Sqr(onDisk.x) - Sqr(onDisk.y)));
                toLamps += double(directions.Pdf(frame.FromLocal(w)) * Pi * sine2 / kDirections);
            }
        }
        // They cover less than a hundredth of what is above p, and are half of the light or more.
        EXPECT_GT(toLamps, 0.12);
        EXPECT_LT(directions.Pdf(Normalize(Vector3(0, -1, 1))), 0.5f);
    }
}

GuideParams Directions(bool roulette = false) { return {.roulette = roulette, .records = 1 << 20}; }

/// A bounce from a horizontal surface, drawn by the cosine.
GuideRecord CosineBounce(const Point3 &p, Rng &rng) {
    GuideRecord r;
    r.p = p;
    r.normal = {0, 0, 1};
    r.wi = SampleCosineHemisphere(rng.Uniform2());
    r.pdf = r.bsdfPdf = r.wi.z / Pi;
    return r;
}

const std::string kBall = Objects().Light("infinite").Shape("sphere");
const std::string kFlat = SceneText().Film(200, 200).Samples(15).World(kBall);

/// A guide that has learned from made-up records at p in [-1, 1]^2 on the plane z = 0: the light of a record in
/// direction w is light(p, w).
template <class Light>
class Learned {
  public:
    Learned(const Light &light, bool isGlossy, bool bothSides = false, const GuideParams &params = Directions(),
            int samples = 31)
        : built_(BuildText(kFlat)), guide(params) {
        PrepareContext context = built_.Preparation(progress_);
        context.samplesPerPixel = samples;
        guide.Prepare(context, 1);
        EXPECT_EQ(guide.NextUpdate(), 2);
        for (int first = 0, next; (next = guide.NextUpdate()) > 0; first = next)
            Learn(light, isGlossy, bothSides, first, next);
    }

  private:
    /// From samples [first, next).
    void Learn(const Light &light, bool isGlossy, bool bothSides, int first, int next) {
        Rng rng(3);
        for (int sample = first; sample < next; ++sample)
            for (int y = 0; y < 200; ++y)
                for (int x = 0; x < 200; ++x) {
                    const std::optional<size_t> path = guide.PathNumber({x, y}, sample);
                    PathObserver::PathPlaces places = guide.BeginRecords(path);
                    const Point3 p{2 * rng.Uniform() - 1, 2 * rng.Uniform() - 1, 0};
                    GuideRecord r = CosineBounce(p, rng);
                    r.beta = 1;
                    if (bothSides && rng.Uniform() < 0.5f) r.wi.z = -r.wi.z;
                    if (bothSides) r.pdf = r.bsdfPdf = r.pdf / 2;
                    r.target = r.p + r.wi * Float(30);
                    r.radiance = r.contribution = light(r.p, r.wi);
                    r.isGlossy = isGlossy;
                    r.bothSides = bothSides;
                    if (r.radiance > 0) guide.Record(places, r);
                    if (!path || !guide.Roulette()) continue;
                    const Float found = rng.Uniform() < 0.5f ? r.radiance : 0;
                    guide.Roulette()->Record(*path, 0, {r.p, 0, {found, 1}, {found, 1}});
                    guide.Roulette()->RecordPath(*path, {found, 2});
                }
        guide.Update(progress_);
    }

    Progress progress_;
    BuiltScene built_;

  public:
    PathGuide guide;
};

Float Even(const Point3 &, const Vector3 &) { return 1; }
Float Lobe(const Point3 &, const Vector3 &w) { return Dot(w, Normalize(Vector3(1, 0.3f, 1))) > 0.9f ? 10.f : 0.1f; }

TEST(PathGuide, LearnsWhereLightComesFrom) {
    Learned lobe(Lobe, false);
    Float share = 0;
    const PerSourceCluster *radiances = lobe.guide.Cells().At({0.2f, 0.1f, 0}, false, 1, &share);
    ASSERT_TRUE(radiances);
    EXPECT_GT(share, 0.2f);
    EXPECT_LE(share, 0.7f);
    GuideDirections directions;
    directions.Prepare(lobe.guide.Cells().Clusters(), *radiances, {0.2f, 0.1f, 0}, {0, 0, 1}, false);
    EXPECT_GT(directions.Pdf(Normalize(Vector3(1, 0.3f, 1))), 4 * directions.Pdf(Normalize(Vector3(-1, 0, 1))));
    // Nothing was learned of glossy surfaces.
    EXPECT_EQ(lobe.guide.Cells().At({0.2f, 0.1f, 0}, true, 1, &share), nullptr);
}

TEST(PathGuide, GuidesOnlyWhereLightComesFromOneSide) {
    Learned half([](const Point3 &p, const Vector3 &w) { return p.x > 0 ? Lobe(p, w) : 1.f; }, false);
    Float share = 0;
    EXPECT_NE(half.guide.Cells().At({0.5f, 0.1f, 0}, false, 1, &share), nullptr);
    EXPECT_EQ(half.guide.Cells().At({-0.5f, 0.1f, 0}, false, 1, &share), nullptr);
}

TEST(PathGuide, LearnsWhenEnoughPathsAreRecorded) {
    const BuiltScene built = BuildText(SceneText().Film(20, 20).World(kBall));
    Progress progress;
    const auto learnings = [&](int samples) {
        PathGuide guide(GuideParams{.roulette = false, .directions = false});
        PrepareContext context = built.Preparation(progress);
        context.samplesPerPixel = samples;
        guide.Prepare(context, 5);
        std::vector<int> after;
        while (guide.NextUpdate() > 0) {
            after.push_back(guide.NextUpdate());
            guide.Update(progress);
        }
        return after;
    };
    EXPECT_EQ(learnings(3), std::vector<int>());
    EXPECT_EQ(learnings(16), (std::vector<int>{2, 4}));
    EXPECT_EQ(learnings(32), (std::vector<int>{2, 4, 16}));
    // 1/32 of 4096 samples per pixel is 128.
    EXPECT_EQ(learnings(4096), (std::vector<int>{128, 256, 1024}));
}

TEST(PathGuide, LearnsNoDirectionsWhereTheyDoNotPay) {
    const GuideParams params = Directions(true);
    const Learned lobe(Lobe, false, false, params), first(Lobe, false, false, params, 7);
    EXPECT_TRUE(lobe.guide.EstimatesDirections());
    EXPECT_TRUE(lobe.guide.Cells().Guide());
    EXPECT_TRUE(first.guide.EstimatesDirections());
    EXPECT_FALSE(first.guide.Cells().Guide()) << "the first samples teach the roulette alone";
    const Learned nothing(Even, false, false, params);
    EXPECT_FALSE(nothing.guide.EstimatesDirections());
    // With so many samples 80,000 paths are recorded, a part of which is tested first.
    const Learned muchOfNothing(Even, false, false, params, 64), muchOfLobe(Lobe, false, false, params, 64);
    EXPECT_FALSE(muchOfNothing.guide.EstimatesDirections());
    EXPECT_TRUE(muchOfLobe.guide.EstimatesDirections());
    EXPECT_TRUE(muchOfLobe.guide.Cells().Guide());
    // One place in a hundred is worth guiding.
    const Learned rarely([](const Point3 &p, const Vector3 &w) { return p.x > 0.98f ? Lobe(p, w) : 10.f; }, false,
                         false, params);
    EXPECT_FALSE(rarely.guide.EstimatesDirections());
    EXPECT_FALSE(rarely.guide.Cells().Guide());
}

/// What cells guide to at a point of the plane z = 0, and with which probability.
GuideDirections DirectionsAt(const GuideCells &cells, const Point3 &p, Float *share) {
    GuideDirections directions;
    if (const PerSourceCluster *radiances = cells.At(p, false, 1e6f, share))
        directions.Prepare(cells.Clusters(), *radiances, p, {0, 0, 1}, false);
    return directions;
}

bool Meets(const Point3 &p, const Vector3 &w, const Point3 &lamp, Float radius) {
    const Float along = Dot(lamp - p, w);
    return along > 0 && Distance(p + w * along, lamp) < radius;
}

/// What a bounce from a floor finds: a lamp, a ball, or else a dim ceiling.
GuideRecord UnderLamps(const Point3 &p, std::span<const Point3> lamps, Float radius, Float radiance, bool isOfFirstHalf,
                       Rng &rng) {
    GuideRecord r = CosineBounce(p, rng);
    r.isOfFirstHalf = isOfFirstHalf;
    r.target = r.p + r.wi * (2 / std::max(r.wi.z, Float(0.1)));
    r.radiance = 0.01f;
    for (const Point3 &lamp : lamps)
        if (Meets(r.p, r.wi, lamp, radius)) {
            r.target = r.p + r.wi * Dot(lamp - r.p, r.wi);
            r.radiance = radiance;
        }
    r.contribution = r.radiance;
    return r;
}

/// Two rooms, x < 0 and x > 0, with a lamp in each behind a wall that hides it from the other room.
TEST(GuideCells, GuideTowardsTheLight) {
    const Point3 lamps[] = {{-1, 0, 1}, {1, 0, 1}};
    constexpr Float kRadius = 0.15f;
    Rng rng(21);
    std::vector<GuideRecord> records;
    for (int i = 0; i < 200000; ++i) {
        const Point3 p(4 * rng.Uniform() - 2, rng.Uniform() - 0.5f, 0);
        records.push_back(UnderLamps(p, {&lamps[p.x > 0 ? 1 : 0], 1}, kRadius, 10, i % 2 == 0, rng));
    }
    GuideCells cells;
    cells.Learn(records, 0.7f);
    for (const Float side : {-1.f, 1.f}) {
        const Point3 p(0.5f * side, 0.1f, 0);
        Float share = 0;
        const GuideDirections directions = DirectionsAt(cells, p, &share);
        ASSERT_TRUE(directions.IsUsable());
        EXPECT_GT(share, 0.3f);
        const Point3 &seen = lamps[side > 0 ? 1 : 0], &hidden = lamps[side > 0 ? 0 : 1];
        int toSeen = 0, toHidden = 0;
        for (int i = 0; i < 10000; ++i) {
            const Vector3 w = directions.Sample(rng.Uniform2());
            toSeen += Meets(p, w, seen, kRadius);
            toHidden += Meets(p, w, hidden, kRadius);
        }
        EXPECT_GT(toSeen, 5000);
        EXPECT_GT(toSeen, 20 * toHidden);
        // Nothing is known of glossy surfaces, and paths that hardly count are not guided.
        EXPECT_FALSE(cells.At(p, true, 1e6f, &share));
        EXPECT_FALSE(cells.At(p, false, 1e-6f, &share));
    }
}

/// More lights than a few clusters can separate, all visible from everywhere.
TEST(GuideCells, GuideTowardsManyLights) {
    constexpr int kSide = 6;
    std::vector<Point3> lamps;
    for (int i = 0; i < kSide * kSide; ++i)
        lamps.emplace_back(0.4f * Float(i % kSide) - 1, 0.4f * Float(i / kSide) - 1, 1);
    Rng rng(8);
    std::vector<GuideRecord> records;
    for (int i = 0; i < 200000; ++i)
        records.push_back(
            UnderLamps({2 * rng.Uniform() - 1, 2 * rng.Uniform() - 1, 0}, lamps, 0.04f, 30, i % 2 == 0, rng));
    GuideCells cells;
    cells.Learn(records, 0.7f);
    const Point3 p(0.1f, -0.05f, 0);
    Float share = 0;
    const GuideDirections directions = DirectionsAt(cells, p, &share);
    ASSERT_TRUE(directions.IsUsable());
    int found = 0;
    for (const Point3 &lamp : lamps) {
        const Vector3 w = Normalize(lamp - p);
        found += directions.Pdf(w) > 3 * w.z / Pi;
    }
    EXPECT_GE(found, kSide * kSide - 1);
}

/// A light that fewer bounces reach than there are cells has nearly all of the second moment: cells without a sample of
/// it take the estimate of their parents.
TEST(GuideCells, GuideTowardsRareContributions) {
    const Point3 lamp(0, 0, 1);
    constexpr Float kRadius = 0.03f;
    Rng rng(5);
    std::vector<GuideRecord> records;
    int finds = 0;
    for (int i = 0; i < 200000; ++i) {
        const Point3 p(rng.Uniform() - 0.5f, rng.Uniform() - 0.5f, 0);
        records.push_back(UnderLamps(p, {&lamp, 1}, kRadius, 100, i % 2 == 0, rng));
        finds += records.back().radiance > 1;
    }
    GuideCells cells;
    cells.Learn(records, 0.7f);
    EXPECT_LT(size_t(finds), cells.Cells());
    constexpr int kPlaces = 200;
    int guiding = 0;
    for (int i = 0; i < kPlaces; ++i) {
        Float share = 0;
        guiding += cells.At({rng.Uniform() - 0.5f, rng.Uniform() - 0.5f, 0}, false, 1e6f, &share) && share > 0.3f;
    }
    EXPECT_GE(guiding, kPlaces * 19 / 20);
}

TEST(PathGuide, ASavedStateIsLoadedBitByBitAndADamagedOneThrows) {
    BuiltScene built = BuildText(SceneText().World(kBall));
    Progress progress;
    const auto load = [&](const std::string &bytes, PathGuide &guide) {
        StateReader reader(bytes, "state");
        PrepareContext context = built.Preparation(progress);
        context.pixelBounds = {{0, 0}, {200, 200}};
        context.samplesPerPixel = 31;
        context.learned = &reader;
        guide.Prepare(context, 1);
    };
    const auto bytesOf = [](const PathGuide &guide) {
        StateWriter writer;
        guide.SaveLearned(writer, true);
        return writer.Joined();
    };
    const Learned lobe(Lobe, false), withoutDirections(Even, false, false, Directions(true));
    const auto check = [&](const PathGuide &guide, const GuideParams &params, bool learns) {
        const std::string state = bytesOf(guide);
        PathGuide other(params);
        load(state, other);
        EXPECT_EQ(bytesOf(other), state);
        EXPECT_EQ(other.EstimatesDirections(), learns);
        for (const std::string &damaged : Damaged(state)) {
            PathGuide rejecting(params);
            EXPECT_THROW(load(damaged, rejecting), UserError);
        }
    };
    check(lobe.guide, Directions(), true);
    check(withoutDirections.guide, Directions(true), false);
}

TEST(PathGuide, WhatItLearnedIsOfUseToOtherRenders) {
    GuideParams params = Directions(true);
    const Learned lobe(Lobe, false, false, params);
    StateWriter writer;
    lobe.guide.SaveLearned(writer, false);
    const std::string bytes = writer.Joined();
    Progress progress;
    const auto load = [&](PathGuide &guide, const std::string &state, const std::string &camera = "") {
        const BuiltScene built = BuildText(camera + kFlat);
        StateReader reader(state, "lights");
        PrepareContext context = built.Preparation(progress);
        context.samplesPerPixel = 4;
        context.learned = &reader;
        context.learnsOn = false;
        guide.Prepare(context, 1);
        EXPECT_EQ(guide.NextUpdate(), 0);
    };
    PathGuide other(params), elsewhere(params);
    load(other, bytes);
    StateWriter again;
    other.SaveLearned(again, false);
    EXPECT_EQ(again.Joined(), bytes);
    EXPECT_TRUE(other.Cells().Guide());
    EXPECT_EQ(other.PixelImportance({7, 5}), lobe.guide.PixelImportance({7, 5}));
    // From elsewhere the picture's brightness is not known.
    load(elsewhere, bytes, "LookAt 0 0 1  0 1 1  0 0 1 Camera \"perspective\"\n");
    EXPECT_TRUE(elsewhere.Cells().Guide());
    EXPECT_EQ(elsewhere.PixelImportance({0, 0}), elsewhere.PixelImportance({190, 120}));

    for (const std::string &damaged : {bytes.substr(0, bytes.size() - 1), bytes.substr(0, 20)}) {
        PathGuide rejecting(params);
        EXPECT_THROW(load(rejecting, damaged), UserError);
    }
    params.share = 0.5f;
    PathGuide different(params);
    ExpectError([&] { load(different, bytes); }, {"share", "0.5"});
}

/// The mean of f cos L / density over guided bounces, where L is the light that was learned, is that over the BSDF's
/// own bounces; it is not if the density leaves the guide out, or has it with a share that is less by `wrong`.
void CheckGuideMean(const Bsdf &bsdf, bool isGlossy, bool bothSides, Float wrong = 0.05f) {
    Learned lobe(Lobe, isGlossy, bothSides);
    PathVertex vertex;
    vertex.point.p = {0.2f, 0.1f, 0};
    vertex.point.wo = Normalize(Vector3(-1, 0.2f, 1));
    vertex.point.n = vertex.point.shading.n = {0, 0, 1};
    vertex.bsdf = bsdf;
    GuidedDirections bounces(lobe.guide, {0, 0}, 5);
    bounces.PrepareDirections(vertex, SampledSpectrum(1));
    Float share = 0;
    ASSERT_TRUE(lobe.guide.Cells().At(vertex.point.p, isGlossy, 1, &share));
    Rng rng(11);
    RunningStatistics own, guided, withoutGuide, wrongShare;
    const auto weightOf = [&](const BsdfSample &s, Float pdf) {
        return double(s.f.Average() * std::abs(s.wi.z) / pdf * Lobe(vertex.point.p, s.wi));
    };
    for (int i = 0; i < 400000; ++i) {
        const std::optional<BsdfSample> a = vertex.bsdf.Sample(vertex.point.wo, rng.Uniform(), rng.Uniform2());
        own.Add(a ? weightOf(*a, a->pdf) : 0);
        const std::optional<BsdfSample> b = bounces.Sample(vertex, rng.Uniform(), rng.Uniform2());
        guided.Add(b ? weightOf(*b, b->pdf) : 0);
        const Float bsdfPdf = b ? vertex.bsdf.Pdf(vertex.point.wo, b->wi) : 0;
        const Float guidePdf = b ? (b->pdf - (1 - share) * bsdfPdf) / share : 0;
        withoutGuide.Add(b && bsdfPdf > 0 ? weightOf(*b, bsdfPdf) : 0);
        wrongShare.Add(b ? weightOf(*b, (1 + wrong - share) * bsdfPdf + (share - wrong) * guidePdf) : 0);
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

TEST(GuidedDirections, HaveTheMeanOfTheBsdfsOwnBounces) {
    const auto bsdf = [](const auto &lobe) { return Bsdf({0, 0, 1}, {1, 0, 0}, lobe); };
    CheckGuideMean(bsdf(DiffuseBxdf(SampledSpectrum(0.7f))), false, false);
    CheckGuideMean(bsdf(DiffuseTransmissionBxdf(SampledSpectrum(0.4f), SampledSpectrum(0.3f))), false, true);
    // Its F is biased, as stock pbrt-v4's is, and its samples are not.
    const auto table = CoatTable::Shared(1.5f, 0.01f, 0.3f);
    CoatedDiffuseBxdf coated(DielectricBxdf(1.5f, TrowbridgeReitz(0.3f, 0.3f)), DiffuseBxdf(SampledSpectrum(0.8f)),
                             0.01f, SampledSpectrum(0), 0, 10, 1);
    coated.UseTable(*table);
    ASSERT_TRUE(coated.UsesTable());
    CheckGuideMean(bsdf(coated), false, false, 0.2f);
}

TEST(GuidedDirections, LeaveSpecularSurfacesAlone) {
    EXPECT_FALSE(PathGuide::Guides(Bsdf({0, 0, 1}, {1, 0, 0}, ThinDielectricBxdf(1.5f))));
    EXPECT_TRUE(PathGuide::Guides(Bsdf({0, 0, 1}, {1, 0, 0}, DiffuseBxdf(SampledSpectrum(0.5f)))));
}

}  // namespace
}  // namespace pbrt::test
