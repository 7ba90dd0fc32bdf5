#include "ext/prepass/trial.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

namespace ext {
namespace {

/// Costs in path vertices, each with the ray that leads to it: measured on sunny-room and the dining room.
constexpr double kPath = 0.5, kShadowRay = 0.25;
constexpr double kTrimmed = 0.01;
constexpr size_t kBlock = TrialPixel::kPerBlock;

double CostOf(std::span<const TrialPixel> trial, double perVertex) {
    double cost = 0;
    for (const TrialPixel &p : trial) cost += kPath * p.paths + perVertex * p.vertices + kShadowRay * p.shadowRays;
    return cost;
}

double SumOfMeans(std::span<const TrialPixel> pixels) {
    return std::accumulate(pixels.begin(), pixels.end(), 0.0,
                           [](double sum, const TrialPixel &p) { return sum + p.mean; });
}

}  // namespace

void TrialRatio::Report(nlohmann::ordered_json &report) const {
    report["relativeError"] = error;
    report["relativeCost"] = cost;
    report["gain"] = Gain();
}

TrialRatio CompareTrials(std::span<const TrialPixel> option, std::span<const TrialPixel> alternative,
                         double extraPerVertex) {
    const size_t blocks = std::min(option.size(), alternative.size()) / kBlock;
    if (blocks == 0) return {};
    const double mean = (SumOfMeans(option) + SumOfMeans(alternative)) / double(option.size() + alternative.size());
    const auto errorOf = [&](std::span<const TrialPixel> trial) {
        std::vector<double> errors;
        for (size_t b = 0; b < blocks; ++b) {
            const double here =
                (SumOfMeans(option.subspan(b * kBlock, kBlock)) + SumOfMeans(alternative.subspan(b * kBlock, kBlock))) /
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
    const double alternativeError = errorOf(alternative), alternativeCost = CostOf(alternative, 1);
    if (!(alternativeError > 0 && alternativeCost > 0)) return {};
    return {errorOf(option) / alternativeError, CostOf(option, 1 + extraPerVertex) / alternativeCost};
}

}  // namespace ext
