#include "ext/lab/bias_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <ranges>
#include <utility>

#include "pbrt/images/metrics.h"
#include "pbrt/math/statistics.h"

// Method. The difficulty is few seeds (often 3) and rare strong samples. A t-test of one tile over 3 seeds has two
// degrees of freedom and no power; where a rare bright path was missed, mean and variance are both low.
//
// Regions. Tiles are nearly independent, so a region's noise is the sum over its tiles, with (seeds - 1) x tiles
// degrees of freedom. The smallest regions ("blocks") hold at least kMinimumData tile means; each level joins 2 x 2
// regions, up to the whole image. Every region is tested in every channel.
//
// Statistic. Mean over the region's tiles of w (runs - reference), w = 1 / (reference mean of the block + a fraction of
// the image mean). w hardly depends on single noisy values, so the statistic is unbiased, bright areas do not dominate,
// and no tile gains weight by accidentally low noise.
//
// Noise. Of the runs and of the reference's parts: variances of tile means plus covariances of neighbouring tiles
// (pixel filters extend over tile borders), or the variance of the region's mean between seeds if larger (random
// numbers shared by the whole image). Degrees of freedom by Welch and Satterthwaite, so a region whose noise is in a
// few tiles has few. For one run, or one reference part of unknown noise: scatter of the differences over the region's
// tiles, which includes both noises.
//
// Heavy tails. Where c strong samples are expected, all are missed with probability exp(-c); mean and estimated noise
// are then too low. So a difference d must exceed the effect of missed samples. If each moves the region's mean by s, d
// corresponds to d / s missed samples, which add s |d| to the variance. The bound d^2 = t^2 variance + c s |d| with c =
// -log(level of one test) is c s where no sample was found, as required. The check uses 0.7 times this c (kUnseen): in
// simulations, false alarms stay at their level, and biases of noisy samplers are detected better. Where a handful of
// samples dominates the noise, the verdict is never "biased", and the smallest visible bias is large.
//
// The strength of missed samples is estimated from images with the same sample distribution. Runs that are too dark may
// lack samples as strong as the strongest in the runs and their auxiliary runs. If they are too bright, the reference
// may lack samples as strong as the strongest in its parts and its sampler's auxiliary runs. Images of other samplers
// are excluded: one sampler may receive a light in many weak samples, another in few strong ones, and a noisy sampler's
// strong samples would hide every bias of a quiet one. The estimate uses the region, its neighbours, and the typical
// value of the image, as light occluded from a sampler is so in many places. "Strong" is the excess over the ordinary
// noise of tiles.
//
// Limits. A sampler is indistinguishable from one that never selects a light if neither its runs nor its auxiliary runs
// have strong samples in this region, and few elsewhere. False alarms and power are measured in bias_check_test.cpp and
// bias_auxiliary_test.cpp.

namespace ext::lab {
namespace {

constexpr int kMinimumData = 32;  ///< tile means (seeds x tiles) in a block
constexpr int kMinRegions = 4;    ///< minimum regions of about 1/16 of the image for a "clean" verdict
constexpr double kUnseen = 0.7;   ///< strong samples that may be missed, in units of -log(level)
constexpr size_t kUsual = 6;      ///< one block in kUsual has a sample at least as strong as the typical one
constexpr double kDark = 0.05;    ///< fraction of the image mean added to every block's mean
constexpr double kManyDof = 1e9;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// One level of regions: the tile grid, divided evenly into rectangles.
struct Cut {
    Point2i count, tiles;
    int Count() const { return count.x * count.y; }
    Bounds2i At(int x, int y) const { return {Point2i(x, y) * tiles / count, Point2i(x + 1, y + 1) * tiles / count}; }
};

std::vector<Cut> Levels(const TileGrid &grid, int runs) {
    auto cut = [&](int side) {
        auto parts = [side](int tiles) { return std::max(1, (tiles + side / 2) / side); };
        return Cut{{parts(grid.tilesX), parts(grid.tilesY)}, {grid.tilesX, grid.tilesY}};
    };
    int side = 2;
    while (side * side * runs < kMinimumData) side *= 2;
    std::vector<Cut> levels;
    for (;; side *= 2) {
        levels.push_back(cut(side));
        if (levels.back().Count() == 1) return levels;
    }
}

/// Strength of single samples, estimated from images of one kind of sampler.
class StrongSamples {
  public:
    explicit StrongSamples(const Cut &blocks) : blocks_(blocks) {}

    /// `sampleRatio`: as in AuxiliaryRuns.
    void Add(const TileNoise &pictures, double sampleRatio) {
        if (pictures.Pictures() < 2) return;
        std::vector<double> ofBlocks;
        ForEachPixel(blocks_.count,
                     [&](int x, int y) { ofBlocks.push_back(sampleRatio * pictures.Strongest(blocks_.At(x, y))); });
        const size_t usual = std::max<size_t>(1, ofBlocks.size() / kUsual);
        if (usual < ofBlocks.size()) {
            std::nth_element(ofBlocks.begin(), ofBlocks.begin() + usual, ofBlocks.end(), std::greater<>());
            usual_ = std::max(usual_, ofBlocks[usual]);
        }
        groups_.push_back({pictures, sampleRatio});
    }
    bool Known() const { return !groups_.empty(); }

    /// Strength of the strongest sample in the tiles `r`, at least the typical one: effect on a tile's mean of one run.
    double Around(const Bounds2i &r) const {
        double strongest = usual_;
        for (const auto &[pictures, ratio] : groups_) strongest = std::max(strongest, ratio * pictures.Strongest(r));
        return strongest;
    }

  private:
    Cut blocks_;
    double usual_ = 0;
    std::vector<std::pair<TileNoise, double>> groups_;
};

class Channel {
  public:
    Channel(std::span<const TileMeans> runs, std::span<const AuxiliaryRuns> auxiliary, const BiasReference &reference,
            int channel, const Cut &blocks)
        : grid_(runs[0].grid), weights_(Weights(reference, channel, blocks)), runs_(runs, channel, weights_),
          parts_(reference.parts, channel, weights_), sampleRatio_(reference.sampleRatio), ofRuns_(blocks),
          ofReference_(blocks) {
        auto add = [&](std::span<const AuxiliaryRuns> pictures, StrongSamples *to) {
            for (const AuxiliaryRuns &k : pictures)
                if (!k.pictures.empty()) to->Add(TileNoise(k.pictures, channel, weights_), k.sampleRatio);
        };
        ofRuns_.Add(runs_, 1);
        add(auxiliary, &ofRuns_);
        ofReference_.Add(parts_, sampleRatio_);
        add(reference.auxiliary, &ofReference_);
        // A side without images uses the other side's estimate.
        if (!ofRuns_.Known()) ofRuns_.Add(parts_, sampleRatio_);
        if (!ofReference_.Known()) ofReference_.Add(runs_, 1);
        if (reference.parts.size() == 1 && reference.relL2 && runs.size() > 1) {
            const std::vector<double> &values = reference.parts[0].values;
            const double mean = std::accumulate(values.begin(), values.end(), 0.) / double(values.size());
            const double epsilon = RelL2Epsilon(mean);
            // Pixel filters correlate neighbouring pixels: a tile's mean has about twice the variance.
            grid_.ForEachTile([&](int t, const Bounds2i &pixels) {
                const double value = reference.parts[0](t, channel);
                known_.push_back(2 * *reference.relL2 * (value * value + epsilon) * weights_[t] * weights_[t] /
                                 double(pixels.Area()));
            });
        }
    }

    /// Noise of the difference, from the samples of runs and reference.
    TileNoise::Estimate SampleNoise(const Bounds2i &r) const {
        const auto tiles = double(r.Area());
        double variance = 0, squared = 0, maxDof = kManyDof;
        auto add = [&](const TileNoise::Estimate &noise) {
            variance += noise.variance;
            if (noise.dof > 0) squared += noise.variance * noise.variance / noise.dof;
        };
        if (runs_.Pictures() > 1) {
            const TileNoise::Estimate noise = runs_.Of(r);
            add(noise);
            // If few runs agree by chance, all noise seems to be the reference's, with too many degrees of freedom.
            if (runs_.Pictures() < TileNoise::kFew && noise.dof > 0) maxDof = noise.dof;
        }
        if (parts_.Pictures() > 1) {
            add(parts_.Of(r));
        } else if (!known_.empty()) {
            ForEachPixel(r, [&](int x, int y) { variance += known_[grid_.Index(x, y)] / (tiles * tiles); });
        }
        return {variance, squared > 0 ? std::min(variance * variance / squared, maxDof) : kManyDof};
    }

    /// `level`: significance level of this test.
    RegionTest Test(const Bounds2i &r, const Bounds2i &around, double allowance, double level) const {
        RegionTest test;
        test.pixels = Bounds2i(grid_.Pixels(r.low.x, r.low.y).low, grid_.Pixels(r.high.x - 1, r.high.y - 1).high);
        const double tiles = double(r.Area());
        double unit = 0;  // weighted mean of the reference
        ForEachPixel(r, [&](int x, int y) {
            test.difference += Difference(x, y) / tiles;
            unit += parts_.Mean(grid_.Index(x, y)) / tiles;
        });
        // About 0.95 in regions of ordinary brightness. The bound limits relative differences of nearly black regions.
        unit = std::max(unit, 0.5);

        const auto runs = double(runs_.Pictures()), parts = double(parts_.Pictures());
        TileNoise::Estimate estimate = SampleNoise(r);
        double lack = ofRuns_.Around(around) / (runs * tiles);
        double surplus = ofReference_.Around(around) / (sampleRatio_ * parts * tiles);
        if (runs < 2 || (parts < 2 && known_.empty())) {
            const TileNoise::Estimate scatter = Scatter(r, test.difference);
            if (scatter.variance >= estimate.variance) estimate = scatter;
            if (runs < 2) {
                std::vector<double> differences;
                ForEachPixel(around, [&](int x, int y) { differences.push_back(Difference(x, y)); });
                const double strongest = Excess(differences) / tiles;
                lack = std::max(lack, strongest);
                surplus = std::max(surplus, strongest);
            }
        }
        test.difference /= unit;
        test.dof = estimate.dof;
        test.standardError = std::sqrt(estimate.variance) / unit;
        if (test.standardError > 0) test.p = StudentTwoSidedP(test.difference / test.standardError, test.dof);
        else test.p = test.difference == 0 ? 1 : 0;

        const double critical = StudentCritical(level, test.dof);
        const double noise = test.standardError > 0 ? critical * test.standardError : 0;
        auto floorWith = [&](double strongest) {
            const double half = -kUnseen * std::log(level) * strongest / unit / 2;
            return std::max(allowance, half + std::hypot(half, noise));
        };
        test.floor = floorWith(test.difference < 0 ? lack : surplus);
        test.biased = test.p < level && std::abs(test.difference) > test.floor;
        test.visible = floorWith(std::max(lack, surplus));
        // NormalCritical(0.2) leaves 10 % on one side; the square root accounts for the error of the noise estimate.
        if (test.standardError > 0 && test.dof > 0)
            test.visible +=
                std::sqrt(1 + critical * critical / (2 * test.dof)) * NormalCritical(0.2) * test.standardError;
        return test;
    }

  private:
    static std::vector<double> Weights(const BiasReference &reference, int channel, const Cut &blocks) {
        const TileGrid &grid = reference.parts[0].grid;
        const auto parts = double(reference.parts.size());
        std::vector<double> value(grid.Count()), weights(value.size());
        double image = 0;
        for (size_t t = 0; t < value.size(); ++t) {
            for (const TileMeans &part : reference.parts) value[t] += part(int(t), channel) / parts;
            image += value[t] / double(value.size());
        }
        ForEachPixel(blocks.count, [&](int blockX, int blockY) {
            const Bounds2i r = blocks.At(blockX, blockY);
            double sum = 0;
            ForEachPixel(r, [&](int x, int y) { sum += value[grid.Index(x, y)]; });
            const double mean = sum / double(r.Area()) + kDark * image;
            ForEachPixel(r, [&](int x, int y) { weights[grid.Index(x, y)] = mean > 0 ? 1 / mean : 0; });
        });
        return weights;
    }

    double Difference(int x, int y) const {
        const int t = grid_.Index(x, y);
        return runs_.Mean(t) - parts_.Mean(t);
    }

    TileNoise::Estimate Scatter(const Bounds2i &r, double mean) const {
        double own = 0, ownSquared = 0, neighbours = 0;
        const auto tiles = double(r.Area());
        if (tiles < 2) return {kInfinity, 0};
        auto off = [&](int x, int y) { return Difference(x, y) - mean; };
        ForEachPixel(r, [&](int x, int y) {
            const double d = off(x, y);
            own += d * d;
            ownSquared += d * d * d * d;
            if (x + 1 < r.high.x) neighbours += d * off(x + 1, y);
            if (y + 1 < r.high.y) neighbours += d * off(x, y + 1);
        });
        TileNoise::Estimate noise;
        noise.variance = (own + std::max(0.0, 2 * neighbours)) / (tiles * (tiles - 1));
        // As in TileNoise::Of; a squared normal deviate has mean square 3.
        if (ownSquared > 0) noise.dof = std::min(3 * own * own / ownSquared - 2, tiles - 1);
        return noise;
    }

    TileGrid grid_;
    std::vector<double> weights_;
    TileNoise runs_, parts_;
    double sampleRatio_;
    StrongSamples ofRuns_, ofReference_;
    std::vector<double> known_;  ///< variances of the weighted tile means, for a one-part reference of known relL2
};

void CheckInput(std::span<const TileMeans> runs, std::span<const AuxiliaryRuns> auxiliary,
                const BiasReference &reference) {
    if (runs.empty() || reference.parts.empty()) throw UserError("The bias check needs runs and a reference.");
    std::vector<std::span<const TileMeans>> all = {runs, reference.parts};
    for (const AuxiliaryRuns &k : auxiliary) all.push_back(k.pictures);
    for (const AuxiliaryRuns &k : reference.auxiliary) all.push_back(k.pictures);
    for (const std::span<const TileMeans> pictures : all)
        for (const TileMeans &m : pictures)
            if (m.grid != runs[0].grid || m.channels != runs[0].channels)
                throw UserError("Runs and reference of the bias check differ in resolution, tiles or channels.");
}

double MeanOf(std::span<const TileMeans> pictures) {
    double sum = 0;
    for (const TileMeans &p : pictures)
        p.grid.ForEachTile([&](int tile, const Bounds2i &pixels) {
            for (int c = 0; c < p.channels; ++c) sum += p(tile, c) * double(pixels.Area());
        });
    return sum / double(pictures.size());
}

std::string Explain(const BiasReport &report, const BiasSettings &settings) {
    const std::string visible =
        fmt::format("{} in the whole image, {} in regions of 1/{} of it, {} in regions of {} pixels",
                    PercentText(report.visibleImage), PercentText(report.visibleSixteenth), report.sixteenthRegions,
                    PercentText(report.visibleSmallest), report.smallestSide);
    const RegionTest &w = report.worst;
    if (report.verdict == BiasVerdict::Biased)
        return fmt::format("{:+.2f} % (standard error {:.2f} %) in pixels x {} to {}, y {} to {}, channel {}.",
                           100 * w.difference, 100 * w.standardError, w.pixels.low.x, w.pixels.high.x, w.pixels.low.y,
                           w.pixels.high.y, w.channel);
    if (report.verdict == BiasVerdict::Clean) return fmt::format("No bias detected; smallest detectable: {}.", visible);
    return fmt::format("Too few data to detect a bias of {}; smallest detectable: {}.", PercentText(settings.interest),
                       visible);
}

/// Tests of all regions of all `levels`, each at significance `level`, by channel and level.
std::vector<RegionTest> TestRegions(std::span<const TileMeans> runs, const BiasReference &reference,
                                    const BiasSettings &settings, std::span<const AuxiliaryRuns> auxiliary,
                                    std::span<const Cut> levels, double level) {
    std::vector<RegionTest> tests;
    for (int c = 0; c < runs[0].channels; ++c) {
        const Channel channel(runs, auxiliary, reference, c, levels[0]);
        for (size_t l = 0; l < levels.size(); ++l) {
            const Cut &cut = levels[l];
            const double allowance = l + 1 == levels.size() ? settings.allowanceImage : settings.allowanceRegion;
            ForEachPixel(cut.count, [&](int x, int y) {
                const Bounds2i low = cut.At(std::max(x - 1, 0), std::max(y - 1, 0));
                const Bounds2i high = cut.At(std::min(x + 1, cut.count.x - 1), std::min(y + 1, cut.count.y - 1));
                RegionTest test = channel.Test(cut.At(x, y), {low.low, high.high}, allowance, level);
                test.level = int(l);
                test.channel = c;
                tests.push_back(test);
            });
        }
    }
    return tests;
}

}  // namespace

const char *BiasVerdictName(BiasVerdict verdict) {
    return verdict == BiasVerdict::Clean ? "clean" : verdict == BiasVerdict::Biased ? "biased" : "unknown";
}

std::string PercentText(double v) {
    if (!std::isfinite(v)) return "none";
    if (v > 10) return "more than 1000 %";
    return std::abs(v) < 0.995 ? fmt::format("{:.2g} %", 100 * v) : fmt::format("{:.0f} %", 100 * v);
}

BiasReport CheckBias(std::span<const TileMeans> runs, const BiasReference &reference, const BiasSettings &settings,
                     std::span<const AuxiliaryRuns> auxiliary) {
    CheckInput(runs, auxiliary, reference);
    const TileGrid &grid = runs[0].grid;
    const std::vector<Cut> levels = Levels(grid, int(runs.size()));

    BiasReport report;
    report.tiles = grid.Count();
    report.smallestSide = levels[0].At(0, 0).high.x * TileGrid::kTileSize;
    const double total = MeanOf(reference.parts);
    if (total != 0) report.meanDifference = MeanOf(runs) / total - 1;

    for (const Cut &cut : levels) report.tests += cut.Count() * runs[0].channels;
    const double level = SidakLevel(settings.level, report.tests);
    const std::vector<RegionTest> tests = TestRegions(runs, reference, settings, auxiliary, levels, level);
    // Level whose regions are closest to 1/16 of the image.
    const auto sixteenth =
        std::ranges::min_element(levels, {}, [](const Cut &cut) { return std::abs(std::log(cut.Count() / 16.0)); });
    report.sixteenthRegions = sixteenth->Count();
    const auto last = int(levels.size()) - 1;
    auto visible = [&](std::ptrdiff_t of) {
        std::vector<double> values;
        for (const RegionTest &t : tests)
            if (t.level == of) values.push_back(t.visible);
        return values;
    };
    report.visibleImage = std::ranges::max(visible(last));
    report.visibleSixteenth = Median(visible(sixteenth - levels.begin()));
    report.visibleSmallest = Median(visible(0));

    auto minP = [&](auto &&isMeant) {
        auto meant = tests | std::views::filter(isMeant);
        return *std::ranges::min_element(meant, {}, &RegionTest::p);
    };
    const bool anyBiased = std::ranges::any_of(tests, &RegionTest::biased);
    report.whole = minP([&](const RegionTest &t) { return t.level == last; });
    report.worst = minP([&](const RegionTest &t) { return t.biased == anyBiased; });
    report.pValue = SidakP(report.worst.p, tests.size());
    // Infinite deviates (p = 0) are shown as a large one.
    report.worstZ = std::copysign(std::min(NormalCritical(report.worst.p), 40.0), report.worst.difference);

    if (anyBiased) report.verdict = BiasVerdict::Biased;
    else if (report.visibleImage <= settings.interest && report.visibleSixteenth <= settings.interest &&
             report.sixteenthRegions >= kMinRegions)
        report.verdict = BiasVerdict::Clean;
    report.text = Explain(report, settings);
    return report;
}

}  // namespace ext::lab
