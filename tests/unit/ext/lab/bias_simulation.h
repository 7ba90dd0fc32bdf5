#pragma once
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "ext/lab/bias_check.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/statistics.h"

namespace ext::lab::test {

/// A random factor of mean 1, never negative: the value of one pixel of a short rendering, relative to the truth.
using Noise = std::function<double(Rng &)>;

inline double Normal(Rng &rng) {
    const double u = std::max(double(rng.Uniform()), 1e-12), v = double(rng.Uniform());
    return std::sqrt(-2 * std::log(u)) * std::cos(6.283185307179586 * v);
}
/// Lognormal noise; its relL2 is about exp(sigma^2) - 1.
inline Noise Lognormal(double sigma) {
    return [sigma](Rng &rng) { return std::exp(sigma * Normal(rng) - sigma * sigma / 2); };
}
/// Noise whose density falls as x^-(alpha + 1); the variance is infinite for alpha <= 2.
inline Noise Pareto(double alpha) {
    return [alpha](Rng &rng) {
        const double u = std::max(1 - double(rng.Uniform()), 1e-9);
        return (alpha - 1) / alpha * std::pow(u, -1 / alpha);
    };
}
/// A smooth part and, with `probability`, a firefly. The fireflies carry `share` of the light; their strengths vary by
/// Lognormal(spread).
inline Noise Fireflies(double probability, double share, double sigma, double spread = 0) {
    return [=, smooth = Lognormal(sigma), strength = Lognormal(spread)](Rng &rng) {
        double v = (1 - share) * smooth(rng);
        if (double(rng.Uniform()) < probability) v += share / probability * (spread > 0 ? strength(rng) : 1);
        return v;
    };
}

struct Experiment {
    Point2i resolution{96, 64};
    int runs = 3;
    int parts = 4, partLength = 4;  ///< the reference: `parts` pictures, each the mean of `partLength` runs
    Noise noise = Lognormal(0.5);
    Noise referenceNoise;  ///< default: `noise`
    /// The pixels that have these noises; the other pixels have a weak lognormal one.
    std::function<bool(int, int)> noisy = [](int, int) { return true; };
    std::function<double(int, int)> truth = [](int x, int y) { return x < 40 ? 0.2 : 1.5 + 0.01 * y; };
    std::function<double(int, int)> bias = [](int, int) { return 0.0; };  ///< relative
    /// Every pixel gets this part of the noise of its right and lower neighbours, as wide filters do.
    double filter = 0;
};

inline TileMeans Render(const Experiment &c, const Noise &noise, int length, bool biased, Rng &rng) {
    const size_t width = size_t(c.resolution.x) + 1;
    const Noise calm = Lognormal(0.3);
    std::vector<double> relative(width * (size_t(c.resolution.y) + 1));
    for (size_t k = 0; k < relative.size(); ++k) {
        const Noise &here = c.noisy(int(k % width), int(k / width)) ? noise : calm;
        double sum = 0;
        for (int i = 0; i < length; ++i) sum += here(rng);
        relative[k] = sum / length;
    }
    Image image(PixelFormat::Float, c.resolution, {"Y"});
    for (int y = 0; y < c.resolution.y; ++y)
        for (int x = 0; x < c.resolution.x; ++x) {
            const double *at = &relative[size_t(y) * width + size_t(x)];
            const double v = (1 - 2 * c.filter) * at[0] + c.filter * (at[1] + at[width]);
            image.Set({x, y}, 0, Float(c.truth(x, y) * (biased ? 1 + c.bias(x, y) : 1) * v));
        }
    return ComputeTileMeans(image);
}

inline BiasReport Simulate(const Experiment &c, uint64_t seed, const BiasSettings &settings = {}, bool single = false) {
    Rng rng(seed, 17);
    std::vector<TileMeans> runs;
    BiasReference reference;
    for (int i = 0; i < c.runs; ++i) runs.push_back(Render(c, c.noise, 1, true, rng));
    reference.sampleRatio = c.partLength;
    const Noise &of = c.referenceNoise ? c.referenceNoise : c.noise;
    if (single) reference.parts.push_back(Render(c, of, c.parts * c.partLength, false, rng));
    else
        for (int i = 0; i < c.parts; ++i) reference.parts.push_back(Render(c, of, c.partLength, false, rng));
    return CheckBias(runs, reference, settings);
}

/// An experiment of several samplers, each with its own noise where `common.noisy` is true. The sampler `best` makes
/// the reference; if `second` is set, that sampler makes another reference, which judges the best.
struct Contest {
    Experiment common;
    struct Sampler {
        Noise noise;
        int kind = 0;         ///< samplers with equal numbers choose lights in the same way
        bool biased = false;  ///< whether it has common.bias
    };
    std::vector<Sampler> samplers;
    size_t best = 0;
    std::optional<size_t> second;
    bool useAuxiliary = true;  ///< false: every verdict uses only the runs and their reference
};

/// The verdicts on all samplers, computed as the lab does.
inline std::vector<BiasVerdict> Simulate(const Contest &contest, uint64_t seed) {
    Rng rng(seed, 23);
    const Experiment &c = contest.common;
    const size_t count = contest.samplers.size();
    auto render = [&](size_t sampler, int pictures, int length) {
        const Contest::Sampler &s = contest.samplers[sampler];
        std::vector<TileMeans> list;
        for (int i = 0; i < pictures; ++i) list.push_back(Render(c, s.noise, length, s.biased, rng));
        return list;
    };
    std::vector<std::vector<TileMeans>> runs, references;
    for (size_t i = 0; i < count; ++i) runs.push_back(render(i, c.runs, 1));
    std::vector<size_t> makers = {contest.best};
    if (contest.second) makers.push_back(*contest.second);
    for (size_t maker : makers) references.push_back(render(maker, c.parts, c.partLength));

    std::vector<BiasVerdict> verdicts;
    for (size_t i = 0; i < count; ++i) {
        const size_t judge = i == contest.best && contest.second ? 1 : 0;
        auto auxiliaryOf = [&](size_t sampler) {
            std::vector<AuxiliaryRuns> auxiliary;
            auto isSameKind = [&](size_t other) {
                return contest.useAuxiliary && contest.samplers[other].kind == contest.samplers[sampler].kind;
            };
            for (size_t k = 0; k < count; ++k)
                if (k != i && isSameKind(k)) auxiliary.push_back({runs[k], 1});
            for (size_t r = 0; r < makers.size(); ++r)
                if (r != judge && isSameKind(makers[r])) auxiliary.push_back({references[r], double(c.partLength)});
            return auxiliary;
        };
        BiasReference reference{references[judge], {}, double(c.partLength), auxiliaryOf(makers[judge])};
        BiasSettings settings;
        settings.level = SidakLevel(settings.level, count);
        verdicts.push_back(CheckBias(runs[i], reference, settings, auxiliaryOf(i)).verdict);
    }
    return verdicts;
}

}  // namespace ext::lab::test
