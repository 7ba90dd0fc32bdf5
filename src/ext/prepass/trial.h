#pragma once
#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {
using namespace pbrt;

/// Result of two trials, of an option relative to its alternative.
struct TrialRatio {
    double error = 0;  ///< relative variance of a sample; 0: there was no trial
    double cost = 0;   ///< of a sample, counted

    bool WasTried() const { return error > 0 && cost > 0; }
    /// Error that the same cost reaches without the option, over that with it.
    double Gain() const { return WasTried() ? 1 / (error * cost) : 0; }
    void Report(auto &report) const {
        report["relativeError"] = error;
        report["relativeCost"] = cost;
        report["gain"] = Gain();
    }
};

/// Compares trials of the same pixels. Relative variance: that of a pixel's samples over the squared mean of its block
/// in both trials plus 1 % of the squared mean of all; the blocks with the largest 1 % are left out, separately for
/// each trial. Cost is counted in path vertices, not timed, so that the choice is reproducible; `extraPerVertex`: what
/// the option adds at each.
inline TrialRatio CompareTrials(std::span<const TrialPixel> option, std::span<const TrialPixel> alternative,
                                double extraPerVertex) {
    constexpr double kTrimmed = 0.01;
    constexpr size_t kBlock = TrialPixel::kPerBlock;
    const auto costOf = [](std::span<const TrialPixel> trial, double perVertex) {
        // In path vertices, each with the ray that leads to it: measured on sunny-room and the dining room.
        constexpr double kPath = 0.5, kShadowRay = 0.25;
        double cost = 0;
        for (const TrialPixel &p : trial) cost += kPath * p.paths + perVertex * p.vertices + kShadowRay * p.shadowRays;
        return cost;
    };
    const auto sumOfMeans = [](std::span<const TrialPixel> pixels) {
        return std::accumulate(pixels.begin(), pixels.end(), 0.0,
                               [](double sum, const TrialPixel &p) { return sum + p.mean; });
    };
    const size_t blocks = std::min(option.size(), alternative.size()) / kBlock;
    if (blocks == 0) return {};
    const double mean = (sumOfMeans(option) + sumOfMeans(alternative)) / double(option.size() + alternative.size());
    const auto errorOf = [&](std::span<const TrialPixel> trial) {
        std::vector<double> errors;
        for (size_t b = 0; b < blocks; ++b) {
            const double here =
                (sumOfMeans(option.subspan(b * kBlock, kBlock)) + sumOfMeans(alternative.subspan(b * kBlock, kBlock))) /
                (2 * kBlock);
            double variance = 0;
            for (const TrialPixel &p : trial.subspan(b * kBlock, kBlock)) variance += p.variance;
            const double unit = here * here + 0.01 * mean * mean;
            errors.push_back(unit > 0 ? variance / unit : 0);
        }
        std::ranges::sort(errors);
        errors.resize(errors.size() - size_t(kTrimmed * double(errors.size())));
        return std::accumulate(errors.begin(), errors.end(), 0.0);
    };
    const double alternativeError = errorOf(alternative), alternativeCost = costOf(alternative, 1);
    if (!(alternativeError > 0 && alternativeCost > 0)) return {};
    return {errorOf(option) / alternativeError, costOf(option, 1 + extraPerVertex) / alternativeCost};
}

}  // namespace ext
