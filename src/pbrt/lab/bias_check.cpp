#include "pbrt/lab/bias_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pbrt/core/error.h"
#include "pbrt/math/statistics.h"

// The method. Few seeds (often 3) and rare strong samples are the difficulty: a t-test of one tile over 3 seeds has two
// degrees of freedom and sees nothing, and where a rare bright path was missed, mean and variance are low together.
//
// Regions. Tiles are nearly independent of each other, so the noise of a region is the sum of the noise of its tiles
// and has (seeds - 1) x tiles degrees of freedom. The smallest regions ("blocks") hold at least kMinimumData tile
// means; the next level joins 2 x 2 of them, and so on up to the whole image. Every region and channel is tested.
//
// Statistic. Mean over the region's tiles of w (runs - reference), w = 1 / (reference mean of the block + a little of
// the image mean). w hardly depends on a single noisy value, so the statistic is unbiased, bright parts do not drown
// dark ones, and no tile counts more because its noise happened to be low.
//
// Noise. Of the runs and of the reference's parts: variances of tile means plus the covariances of neighbouring tiles
// (pixel filters reach over tile borders), or the variance of the region's mean from seed to seed if that is larger
// (random numbers shared by the whole picture). Degrees of freedom by Welch and Satterthwaite, so a region whose noise
// sits in a few tiles has few. If the reference has one part of unknown noise, or there is one run: scatter of the
// differences over the region's tiles, which holds both noises.
//
// Heavy tails. Where c strong samples were expected, none is seen with probability exp(-c); then the mean is low and so
// is the estimated noise. So a difference must also exceed what c unseen samples would make, each as strong as the
// strongest one seen in the region, around it, or in the reference there (what sticks out of the ordinary noise of
// tiles); and an allowance. c is half of -log(level of one test): such a difference must pass the t-test as well.
// Noise that is decided by a handful of samples never gives "biased", and the smallest visible bias says so. False
// alarms and power are measured in bias_check_test.cpp. In a run of that simulation with 5460 campaigns without bias
// (lognormal, Pareto, fireflies, everywhere or in a part of the picture; 2, 3, 8 and 24 runs) 10 were called biased,
// where the level would allow 27; with the whole -log it were 4, with 0.35 of it 25. Renders can be
// worse: where the reference's sampler finds in many weak samples what another finds in few strong ones, which its few
// runs have missed, neither shows how strong they are (docs/measured, many-rooms).

namespace pbrt::lab {

namespace {

constexpr int kMinimumData = 32;                ///< tile means (seeds x tiles) in a block
constexpr int kFewestRegions = 4;               ///< that pass for "about 1/16 of the picture"
constexpr double kUnseen = 0.5;                 ///< strong samples that may have been missed, times -log(level)
constexpr double kDark = 0.05;                  ///< of the image mean, added to every block's mean
constexpr double kDeviationPerMedian = 1.4826;  ///< normal deviates: standard deviation over median size
constexpr double kManyDof = 1e9;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A rectangle of tiles, half-open.
struct Rectangle {
    int x0, y0, x1, y1;
};

/// One level of regions: the tiles, cut as evenly as possible.
struct Cut {
    int countX = 1, countY = 1, tilesX = 1, tilesY = 1;
    int Count() const { return countX * countY; }
    Rectangle At(int x, int y) const {
        return {x * tilesX / countX, y * tilesY / countY, (x + 1) * tilesX / countX, (y + 1) * tilesY / countY};
    }
};

std::vector<Cut> Levels(const TileGrid &grid, int runs) {
    auto cut = [&](int side) {
        auto parts = [side](int tiles) { return std::max(1, (tiles + side / 2) / side); };
        return Cut{parts(grid.tilesX), parts(grid.tilesY), grid.tilesX, grid.tilesY};
    };
    int side = 2;
    while (side * side * runs < kMinimumData) side *= 2;
    std::vector<Cut> levels;
    for (;; side *= 2) {
        levels.push_back(cut(side));
        if (levels.back().countX == 1 && levels.back().countY == 1) return levels;
    }
}

double Median(std::vector<double> values) {
    if (values.empty()) return kInfinity;
    auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Weighted values of equally good pictures, one channel.
class Group {
  public:
    Group(std::span<const TileMeans> pictures, int channel, const std::vector<double> &weights) {
        const TileGrid &grid = pictures[0].grid;
        grid_ = grid;
        n_ = pictures.size();
        const auto tiles = static_cast<size_t>(grid.Count());
        mean_.assign(tiles, 0);
        residual_.resize(n_ * tiles);
        for (size_t t = 0; t < tiles; ++t) {
            for (size_t i = 0; i < n_; ++i) {
                residual_[i * tiles + t] = weights[t] * pictures[i](static_cast<int>(t), channel);
                mean_[t] += residual_[i * tiles + t] / static_cast<double>(n_);
            }
            for (size_t i = 0; i < n_; ++i) residual_[i * tiles + t] -= mean_[t];
        }
    }

    double Mean(size_t tile) const { return mean_[tile]; }

    struct Noise {
        double variance = 0, dof = 0;
    };
    /// Of the mean over a region; needs two pictures.
    Noise Of(const Rectangle &r) const {
        const auto n = static_cast<double>(n_);
        double own = 0, ownSquared = 0, neighbours = 0, between = 0;
        int tiles = 0;
        for (size_t i = 0; i < n_; ++i) {
            double total = 0;
            for (int y = r.y0; y < r.y1; ++y)
                for (int x = r.x0; x < r.x1; ++x) {
                    const double e = Residual(i, x, y);
                    total += e;
                    // Each pair once; the other half is the factor 2 below.
                    if (x + 1 < r.x1) neighbours += e * Residual(i, x + 1, y);
                    if (y + 1 < r.y1) {
                        neighbours += e * Residual(i, x, y + 1);
                        if (x + 1 < r.x1) neighbours += e * Residual(i, x + 1, y + 1);
                        if (x > r.x0) neighbours += e * Residual(i, x - 1, y + 1);
                    }
                }
            between += total * total;
        }
        for (int y = r.y0; y < r.y1; ++y)
            for (int x = r.x0; x < r.x1; ++x, ++tiles) {
                double squares = 0;
                for (size_t i = 0; i < n_; ++i) squares += Residual(i, x, y) * Residual(i, x, y);
                own += squares;
                ownSquared += squares * squares;
            }
        Noise noise;
        const double sum = std::max(own + std::max(0.0, 2 * neighbours), between);
        noise.variance = sum / (n * (n - 1) * tiles * tiles);
        // Satterthwaite's estimate from squares that are too large by (n + 1) / (n - 1), being estimates themselves;
        // right for equal tiles ((n - 1) tiles - 2) and if one tile has all the noise (n - 1).
        if (ownSquared > 0) noise.dof = std::min((n + 1) * own * own / ownSquared - 2, (n - 1) * tiles);
        return noise;
    }

    /// How far the strongest tile of one picture within `r` rises above what ordinary noise explains there (three
    /// robust standard deviations); needs two pictures.
    double Strongest(const Rectangle &r) const {
        double largest = 0;
        std::vector<double> sizes;
        for (size_t i = 0; i < n_; ++i)
            for (int y = r.y0; y < r.y1; ++y)
                for (int x = r.x0; x < r.x1; ++x) {
                    largest = std::max(largest, Residual(i, x, y));
                    sizes.push_back(std::abs(Residual(i, x, y)));
                }
        // The picture itself pulled the mean up.
        const double scale = static_cast<double>(n_) / static_cast<double>(n_ - 1);
        return scale * std::max(0.0, largest - 3 * kDeviationPerMedian * Median(std::move(sizes)));
    }

    size_t Count() const { return n_; }

  private:
    double Residual(size_t picture, int x, int y) const {
        return residual_[picture * mean_.size() + static_cast<size_t>(grid_.Index(x, y))];
    }
    TileGrid grid_;
    size_t n_ = 0;
    std::vector<double> mean_, residual_;
};

/// One channel of the whole check.
class Channel {
  public:
    Channel(std::span<const TileMeans> runs, const BiasReference &reference, int channel, const Cut &blocks)
        : grid_(runs[0].grid),
          weights_(Weights(reference, channel, blocks)),
          runs_(runs, channel, weights_),
          parts_(reference.parts, channel, weights_),
          sampleRatio_(reference.sampleRatio) {
        if (reference.parts.size() == 1 && reference.relL2 && runs.size() > 1) {
            // Pixel filters make neighbouring pixels alike: a tile's mean has about twice the variance.
            for (int t = 0; t < grid_.Count(); ++t) {
                const auto i = static_cast<size_t>(t);
                const Bounds2i pixels = grid_.Pixels(t % grid_.tilesX, t / grid_.tilesX);
                const double area = (pixels.high.x - pixels.low.x) * (pixels.high.y - pixels.low.y);
                const double value = reference.parts[0](t, channel);
                known_.push_back(2 * *reference.relL2 * (value * value + 0.01) * weights_[i] * weights_[i] / area);
            }
        }
    }

    RegionTest Test(const Rectangle &r, const Rectangle &around, double allowance, double unseen) const {
        RegionTest test;
        test.pixels = Bounds2i(grid_.Pixels(r.x0, r.y0).low, grid_.Pixels(r.x1 - 1, r.y1 - 1).high);
        const double tiles = (r.x1 - r.x0) * (r.y1 - r.y0);
        double level = 0;  // what the reference is in the units of the weights
        for (int y = r.y0; y < r.y1; ++y)
            for (int x = r.x0; x < r.x1; ++x) {
                test.difference += Difference(x, y) / tiles;
                level += parts_.Mean(static_cast<size_t>(grid_.Index(x, y))) / tiles;
            }
        // A region of ordinary brightness: 0.95 or so. Nearly black ones are not blown up.
        level = std::max(level, 0.5);

        const auto runs = static_cast<double>(runs_.Count()), parts = static_cast<double>(parts_.Count());
        double variance = 0, squared = 0, firefly = 0;
        auto add = [&](const Group::Noise &noise) {
            variance += noise.variance;
            if (noise.dof > 0) squared += noise.variance * noise.variance / noise.dof;
        };
        if (runs > 1) {
            add(runs_.Of(r));
            firefly = runs_.Strongest(around) / (runs * tiles);
        }
        if (parts > 1) {
            add(parts_.Of(r));
            // Missed by the reference, or by the runs.
            firefly = std::max(firefly, parts_.Strongest(around) * std::max(1 / parts, sampleRatio_ / runs) / tiles);
        } else if (!known_.empty()) {
            for (int y = r.y0; y < r.y1; ++y)
                for (int x = r.x0; x < r.x1; ++x)
                    variance += known_[static_cast<size_t>(grid_.Index(x, y))] / (tiles * tiles);
        }
        test.dof = squared > 0 ? variance * variance / squared : kManyDof;
        if (runs < 2 || (parts < 2 && known_.empty())) {
            const Group::Noise scatter = Scatter(r, test.difference);
            if (scatter.variance >= variance) {
                variance = scatter.variance;
                test.dof = scatter.dof;
            }
            if (runs < 2) firefly = std::max(firefly, StrongestDifference(around) / tiles);
        }
        test.difference /= level;
        test.standardError = std::sqrt(variance) / level;
        test.floor = std::max(allowance, unseen * firefly / level);
        if (test.standardError > 0)
            test.p = StudentTwoSidedP(test.difference / test.standardError, test.dof);
        else
            test.p = test.difference == 0 ? 1 : 0;
        return test;
    }

  private:
    static std::vector<double> Weights(const BiasReference &reference, int channel, const Cut &blocks) {
        const TileGrid &grid = reference.parts[0].grid;
        const auto parts = static_cast<double>(reference.parts.size());
        std::vector<double> value(static_cast<size_t>(grid.Count())), weights(value.size());
        double image = 0;
        for (size_t t = 0; t < value.size(); ++t) {
            for (const TileMeans &part : reference.parts) value[t] += part(static_cast<int>(t), channel) / parts;
            image += value[t] / static_cast<double>(value.size());
        }
        for (int by = 0; by < blocks.countY; ++by)
            for (int bx = 0; bx < blocks.countX; ++bx) {
                const Rectangle r = blocks.At(bx, by);
                double sum = 0;
                for (int y = r.y0; y < r.y1; ++y)
                    for (int x = r.x0; x < r.x1; ++x) sum += value[static_cast<size_t>(grid.Index(x, y))];
                const double mean = sum / ((r.x1 - r.x0) * (r.y1 - r.y0)) + kDark * image;
                for (int y = r.y0; y < r.y1; ++y)
                    for (int x = r.x0; x < r.x1; ++x)
                        weights[static_cast<size_t>(grid.Index(x, y))] = mean > 0 ? 1 / mean : 0;
            }
        return weights;
    }

    double Difference(int x, int y) const {
        const auto t = static_cast<size_t>(grid_.Index(x, y));
        return runs_.Mean(t) - parts_.Mean(t);
    }

    /// As Group::Strongest, if there is one run.
    double StrongestDifference(const Rectangle &r) const {
        double largest = 0;
        std::vector<double> sizes;
        for (int y = r.y0; y < r.y1; ++y)
            for (int x = r.x0; x < r.x1; ++x) {
                largest = std::max(largest, Difference(x, y));
                sizes.push_back(std::abs(Difference(x, y)));
            }
        return std::max(0.0, largest - 3 * kDeviationPerMedian * Median(std::move(sizes)));
    }

    Group::Noise Scatter(const Rectangle &r, double mean) const {
        double own = 0, ownSquared = 0, neighbours = 0;
        const double tiles = (r.x1 - r.x0) * (r.y1 - r.y0);
        if (tiles < 2) return {kInfinity, 0};
        auto off = [&](int x, int y) { return Difference(x, y) - mean; };
        for (int y = r.y0; y < r.y1; ++y)
            for (int x = r.x0; x < r.x1; ++x) {
                const double d = off(x, y);
                own += d * d;
                ownSquared += d * d * d * d;
                if (x + 1 < r.x1) neighbours += d * off(x + 1, y);
                if (y + 1 < r.y1) neighbours += d * off(x, y + 1);
            }
        Group::Noise noise;
        noise.variance = (own + std::max(0.0, 2 * neighbours)) / (tiles * (tiles - 1));
        // As Group::Of: a squared normal deviate has mean square 3.
        if (ownSquared > 0) noise.dof = std::min(3 * own * own / ownSquared - 2, tiles - 1);
        return noise;
    }

    TileGrid grid_;
    std::vector<double> weights_;
    Group runs_, parts_;
    double sampleRatio_;
    std::vector<double> known_;  ///< variance of the reference's weighted tile means, if that is all there is
};

void CheckInput(std::span<const TileMeans> runs, const BiasReference &reference) {
    if (runs.empty() || reference.parts.empty()) throw UserError("The bias check needs runs and a reference.");
    const TileMeans &first = runs[0];
    auto matches = [&](const TileMeans &m) { return m.grid == first.grid && m.channels == first.channels; };
    if (!std::all_of(runs.begin(), runs.end(), matches) ||
        !std::all_of(reference.parts.begin(), reference.parts.end(), matches))
        throw UserError("Runs and reference of the bias check differ in resolution, tiles or channels.");
}

double MeanOf(std::span<const TileMeans> pictures) {
    double sum = 0;
    for (const TileMeans &p : pictures)
        for (int t = 0; t < p.grid.Count(); ++t) {
            const Bounds2i b = p.grid.Pixels(t % p.grid.tilesX, t / p.grid.tilesX);
            const double area = (b.high.x - b.low.x) * (b.high.y - b.low.y);
            for (int c = 0; c < p.channels; ++c) sum += p(t, c) * area;
        }
    return sum / static_cast<double>(pictures.size());
}

std::string Percent(double v) {
    if (!std::isfinite(v)) return "any size";
    if (v > 10) return "more than 1000 %";
    return std::abs(v) < 0.995 ? fmt::format("{:.2g} %", 100 * v) : fmt::format("{:.0f} %", 100 * v);
}

std::string Explain(const BiasReport &report, const BiasSettings &settings) {
    const std::string visible = fmt::format(
        "{} in the whole image, {} in regions of 1/{} of it, {} in regions of {} pixels", Percent(report.visibleImage),
        Percent(report.visibleSixteenth), report.sixteenthRegions, Percent(report.visibleSmallest), report.smallestSide);
    const RegionTest &w = report.worst;
    switch (report.verdict) {
        case BiasVerdict::Clean:
            return fmt::format("No bias seen; it would have been from {} on.", visible);
        case BiasVerdict::Unknown:
            return fmt::format("Too few data to see a bias of {}; smallest that could be seen: {}.",
                               Percent(settings.interest), visible);
        case BiasVerdict::Biased:
            return fmt::format("{:+.2f} % (standard error {:.2f} %) in pixels x {} to {}, y {} to {}, channel {}.",
                               100 * w.difference, 100 * w.standardError, w.pixels.low.x, w.pixels.high.x,
                               w.pixels.low.y, w.pixels.high.y, w.channel);
    }
    return {};
}

}  // namespace

const char *BiasVerdictName(BiasVerdict verdict) {
    switch (verdict) {
        case BiasVerdict::Clean:
            return "clean";
        case BiasVerdict::Biased:
            return "biased";
        case BiasVerdict::Unknown:
            break;
    }
    return "unknown";
}

BiasReport CheckBias(std::span<const TileMeans> runs, const BiasReference &reference, const BiasSettings &settings) {
    CheckInput(runs, reference);
    const TileGrid &grid = runs[0].grid;
    const std::vector<Cut> levels = Levels(grid, static_cast<int>(runs.size()));

    BiasReport report;
    report.runs = static_cast<int>(runs.size());
    report.tiles = grid.Count();
    report.smallestSide = levels[0].At(0, 0).x1 * grid.tileSize;
    const double total = MeanOf(reference.parts);
    if (total != 0) report.meanDifference = MeanOf(runs) / total - 1;

    for (const Cut &cut : levels) report.tests += cut.Count() * runs[0].channels;
    const double level = SidakLevel(settings.level, static_cast<size_t>(report.tests));
    const double unseen = -kUnseen * std::log(level);
    std::vector<RegionTest> tests;
    for (int c = 0; c < runs[0].channels; ++c) {
        const Channel channel(runs, reference, c, levels[0]);
        for (size_t l = 0; l < levels.size(); ++l) {
            const Cut &cut = levels[l];
            const bool whole = l + 1 == levels.size();
            const double allowance = whole ? settings.allowanceImage : settings.allowanceRegion;
            for (int y = 0; y < cut.countY; ++y)
                for (int x = 0; x < cut.countX; ++x) {
                    const Rectangle low = cut.At(std::max(x - 1, 0), std::max(y - 1, 0));
                    const Rectangle high = cut.At(std::min(x + 1, cut.countX - 1), std::min(y + 1, cut.countY - 1));
                    RegionTest test = channel.Test(cut.At(x, y), {low.x0, low.y0, high.x1, high.y1}, allowance, unseen);
                    test.level = static_cast<int>(l);
                    test.channel = c;
                    tests.push_back(test);
                }
        }
    }

    const double imageArea = static_cast<double>(grid.resolution.x) * grid.resolution.y;
    // The level whose regions are nearest to 1/16 of the image.
    size_t sixteenth = 0;
    auto offSixteenth = [&](size_t l) { return std::abs(std::log(levels[l].Count() / 16.0)); };
    for (size_t l = 1; l < levels.size(); ++l)
        if (offSixteenth(l) < offSixteenth(sixteenth)) sixteenth = l;

    report.sixteenthRegions = levels[sixteenth].Count();
    std::vector<double> visibleWhole, visibleSixteenth, visibleSmallest;
    bool anyBiased = false;
    for (RegionTest &t : tests) {
        const double critical = StudentCritical(level, t.dof);
        t.visible = t.floor;
        if (t.standardError > 0) {
            // 10 % on one side; the estimated noise varies too.
            const double margin =
                t.dof > 0 ? std::sqrt(1 + critical * critical / (2 * t.dof)) * NormalCritical(0.2) : 0;
            t.visible = std::max(t.floor, critical * t.standardError) + margin * t.standardError;
        }
        t.biased = t.p < level && std::abs(t.difference) > t.floor;
        anyBiased |= t.biased;
        if (t.level + 1 == static_cast<int>(levels.size())) visibleWhole.push_back(t.visible);
        if (t.level == static_cast<int>(sixteenth)) visibleSixteenth.push_back(t.visible);
        if (t.level == 0) visibleSmallest.push_back(t.visible);
    }
    report.visibleImage = *std::max_element(visibleWhole.begin(), visibleWhole.end());
    report.visibleSixteenth = Median(visibleSixteenth);
    report.visibleSmallest = Median(visibleSmallest);

    bool first = true, firstWhole = true;
    for (const RegionTest &t : tests) {
        if (t.level + 1 == static_cast<int>(levels.size()) && (firstWhole || t.p < report.whole.p)) {
            report.whole = t;
            firstWhole = false;
        }
        if (t.biased != anyBiased) continue;
        if (first || t.p < report.worst.p) report.worst = t;
        first = false;
    }
    report.pValue = SidakP(report.worst.p, tests.size());
    // A deviate that has no finite value (p = 0) is shown as a large one.
    report.worstZ = std::copysign(std::min(NormalCritical(report.worst.p), 40.0), report.worst.difference);

    if (anyBiased)
        report.verdict = BiasVerdict::Biased;
    else if (imageArea > 0 && report.visibleImage <= settings.interest && report.visibleSixteenth <= settings.interest &&
             report.sixteenthRegions >= kFewestRegions)
        report.verdict = BiasVerdict::Clean;
    report.text = Explain(report, settings);
    return report;
}

}  // namespace pbrt::lab
