#include "ext/prepass/trial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "pbrt/core/counters.h"
#include "pbrt/core/parallel.h"
#include "pbrt/samplers/sampler.h"

namespace ext {
namespace {

constexpr int kGroup = 8;  ///< samples of a pixel, twice
constexpr double kShare = 0.015, kMaxShare = 0.03;
constexpr double kMinPixels = 256, kMaxPixels = 4096;
constexpr uint64_t kTrialStream = 0x747269616c;

/// `samplers`: two of the render's kind, with seeds of their own. Their means over kGroup samples, which are as well
/// distributed as the render's, give the variance.
TrialPixel TracePixel(const PrepareContext &context, Point2i pixel,
                      std::span<const std::unique_ptr<Sampler>, 2> samplers) {
    RenderCounters &counters = ThreadCounters();
    const RenderCounters before = counters;
    double mean[2] = {};
    for (size_t k = 0; k < 2; ++k) {
        for (int i = 0; i < kGroup; ++i) {
            samplers[k]->StartPixelSample(pixel, i);
            // No sample of the render has this number.
            mean[k] += context.tracePath(pixel, std::numeric_limits<int>::max() - i, *samplers[k]) / kGroup;
        }
    }
    TrialPixel result;
    result.mean = (mean[0] + mean[1]) / 2;
    result.variance = kGroup * (mean[0] - mean[1]) * (mean[0] - mean[1]) / 2;
    result.paths = 2 * kGroup;
    result.vertices = double(counters.pathVertices - before.pathVertices);
    result.shadowRays = double(counters.shadowRays - before.shadowRays);
    counters = before;
    return result;
}

double SamplesOf(const PrepareContext &context) { return double(context.pixelBounds.Area()) * context.samplesPerPixel; }

}  // namespace

bool CanTrace(const PrepareContext &context) {
    return context.tracePath && kMinPixels * 2 * kGroup <= kMaxShare * SamplesOf(context);
}

std::vector<TrialPixel> TraceTrial(const PrepareContext &context) {
    const Bounds2i &bounds = context.pixelBounds;
    const double wanted = std::clamp(kShare * SamplesOf(context) / (2 * kGroup), kMinPixels, kMaxPixels);
    // Pixels at equal steps, in blocks of two by two.
    const int step = std::max(1, int(std::sqrt(double(bounds.Area()) / wanted)));
    const Vector2i blocks = (bounds.high - bounds.low) / (2 * step);
    std::vector<TrialPixel> result(size_t(blocks.x) * blocks.y * TrialPixel::kPerBlock);
    context.progress.BeginPhase("trial", int64_t(result.size()));
    ParallelForEach(int64_t(result.size()) / TrialPixel::kPerBlock, [&](int64_t b) {
        std::array<std::unique_ptr<Sampler>, 2> samplers;
        for (size_t k = 0; k < 2; ++k) samplers[k] = context.sampler.WithSeed(int(Hash(kTrialStream, context.seed, k)));
        const Point2i block(int(b % blocks.x), int(b / blocks.x));
        for (int i = 0; i < TrialPixel::kPerBlock && !context.progress.Cancelled(); ++i) {
            const Point2i pixel = bounds.low + (2 * block + Point2i(i % 2, i / 2)) * step + step / 2;
            result[b * TrialPixel::kPerBlock + i] = TracePixel(context, pixel, samplers);
            context.progress.Advance();
        }
    });
    context.progress.EndPhase();
    if (context.progress.Cancelled()) result.clear();
    return result;
}

TrialRatio CompareTrials(std::span<const TrialPixel> option, std::span<const TrialPixel> alternative,
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
