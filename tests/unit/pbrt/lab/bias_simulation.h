#pragma once
#include <cmath>
#include <functional>
#include <vector>

#include "pbrt/lab/bias_check.h"
#include "pbrt/math/rng.h"

namespace pbrt::lab::test {

/// Draws of mean 1, never negative: what one pixel of a short rendering is, relative to the truth.
using Noise = std::function<double(Rng &)>;

inline double Normal(Rng &rng) {
    const double u = std::max(static_cast<double>(rng.Uniform()), 1e-12), v = static_cast<double>(rng.Uniform());
    return std::sqrt(-2 * std::log(u)) * std::cos(6.283185307179586 * v);
}
/// relL2 is about exp(sigma^2) - 1.
inline Noise Lognormal(double sigma) {
    return [sigma](Rng &rng) { return std::exp(sigma * Normal(rng) - sigma * sigma / 2); };
}
/// Density falls as x^-(alpha + 1); the variance is infinite for alpha <= 2.
inline Noise Pareto(double alpha) {
    return [alpha](Rng &rng) {
        const double u = std::max(1 - static_cast<double>(rng.Uniform()), 1e-9);
        return (alpha - 1) / alpha * std::pow(u, -1 / alpha);
    };
}
/// A smooth part, and with `probability` a firefly; `share` of the light comes from fireflies.
inline Noise Fireflies(double probability, double share, double sigma) {
    return [=, smooth = Lognormal(sigma)](Rng &rng) {
        double v = (1 - share) * smooth(rng);
        if (static_cast<double>(rng.Uniform()) < probability) v += share / probability;
        return v;
    };
}

struct Campaign {
    Point2i resolution{96, 64};
    int runs = 3;
    int parts = 4, partLength = 4;  ///< the reference: `parts` pictures, each the mean of `partLength` runs
    Noise noise = Lognormal(0.5);
    Noise referenceNoise;  ///< default: `noise`
    /// Where these noises are; elsewhere it is a little lognormal one.
    std::function<bool(int, int)> noisy = [](int, int) { return true; };
    std::function<double(int, int)> truth = [](int x, int y) { return x < 40 ? 0.2 : 1.5 + 0.01 * y; };
    std::function<double(int, int)> bias = [](int, int) { return 0.0; };  ///< relative
    /// Every pixel gets this part of the noise of its right and lower neighbours, as wide filters do.
    double filter = 0;
};

inline TileMeans Render(const Campaign &c, const Noise &noise, int length, bool biased, Rng &rng) {
    const size_t width = static_cast<size_t>(c.resolution.x) + 1;
    const Noise calm = Lognormal(0.3);
    std::vector<double> relative(width * (static_cast<size_t>(c.resolution.y) + 1));
    for (size_t k = 0; k < relative.size(); ++k) {
        const Noise &here = c.noisy(static_cast<int>(k % width), static_cast<int>(k / width)) ? noise : calm;
        double sum = 0;
        for (int i = 0; i < length; ++i) sum += here(rng);
        relative[k] = sum / length;
    }
    Image image(PixelFormat::Float, c.resolution, {"Y"});
    for (int y = 0; y < c.resolution.y; ++y)
        for (int x = 0; x < c.resolution.x; ++x) {
            const double *at = &relative[static_cast<size_t>(y) * width + static_cast<size_t>(x)];
            const double v = (1 - 2 * c.filter) * at[0] + c.filter * (at[1] + at[width]);
            image.Set({x, y}, 0, static_cast<Float>(c.truth(x, y) * (biased ? 1 + c.bias(x, y) : 1) * v));
        }
    return ComputeTileMeans(image);
}

inline BiasReport Simulate(const Campaign &c, uint64_t seed, const BiasSettings &settings = {}, bool single = false) {
    Rng rng(seed, 17);
    std::vector<TileMeans> runs;
    BiasReference reference;
    for (int i = 0; i < c.runs; ++i) runs.push_back(Render(c, c.noise, 1, true, rng));
    reference.sampleRatio = c.partLength;
    const Noise &of = c.referenceNoise ? c.referenceNoise : c.noise;
    if (single)
        reference.parts.push_back(Render(c, of, c.parts * c.partLength, false, rng));
    else
        for (int i = 0; i < c.parts; ++i) reference.parts.push_back(Render(c, of, c.partLength, false, rng));
    return CheckBias(runs, reference, settings);
}

}  // namespace pbrt::lab::test
