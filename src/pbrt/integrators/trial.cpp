#include "pbrt/integrators/trial.h"

#include "pbrt/core/counters.h"
#include "pbrt/core/parallel.h"
#include "pbrt/samplers/random_samplers.h"

namespace pbrt {

namespace {

constexpr int kSamples = 4;  ///< per pixel
constexpr double kShare = 0.015, kMaxShare = 0.03;
constexpr double kMinPixels = 1024, kMaxPixels = 16384;
constexpr uint64_t kStream = 0x747269616c;

/// Radiance of a sample, mean over wavelengths; 0 if invalid.
double TraceSample(const PrepareContext &context, const FollowPath &follow, Point2i pixel, int index,
                   Sampler &sampler) {
    sampler.StartPixelSample(pixel, index);
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(sampler.Get1D());
    const FilterSample offset = context.filter.Sample(sampler.GetPixel2D());
    const CameraSample cs{.pFilm = Point2(pixel) + Point2(0.5f, 0.5f) + offset.offset,
                          .pLens = sampler.Get2D(),
                          .time = sampler.Get1D(),
                          .filterWeight = offset.weight};
    const std::optional<CameraRay> ray = context.camera.GenerateRay(cs, lambda);
    if (!ray) return 0;
    const SampledSpectrum L =
        ray->weight * follow({*ray, pixel, std::numeric_limits<int>::max() - index}, lambda, sampler);
    const double value = double(L.Average() * offset.weight);
    return std::isfinite(value) ? value : 0;
}

TrialPixel TracePixel(const PrepareContext &context, const FollowPath &follow, Point2i pixel, Sampler &sampler) {
    RenderCounters &counters = ThreadCounters();
    const RenderCounters before = counters;
    double sum = 0, sumOfSquares = 0;
    for (int i = 0; i < kSamples; ++i) {
        const double value = TraceSample(context, follow, pixel, i, sampler);
        sum += value;
        sumOfSquares += value * value;
    }
    TrialPixel result;
    result.mean = sum / kSamples;
    result.variance = std::max(sumOfSquares - sum * result.mean, 0.0) / (kSamples - 1);
    result.paths = kSamples;
    result.vertices = double(counters.pathVertices - before.pathVertices);
    result.shadowRays = double(counters.shadowRays - before.shadowRays);
    counters = before;
    return result;
}

}  // namespace

std::vector<TrialPixel> TraceTrial(const PrepareContext &context, const FollowPath &follow) {
    const Bounds2i &bounds = context.pixelBounds;
    const double pixels = double(bounds.Area()), samples = pixels * context.samplesPerPixel;
    if (kMinPixels * kSamples > kMaxShare * samples) return {};
    const double wanted = std::clamp(kShare * samples / kSamples, kMinPixels, kMaxPixels);
    // Pixels at equal steps, in blocks of two by two.
    const int step = std::max(1, int(std::sqrt(pixels / wanted)));
    const Vector2i blocks = (bounds.high - bounds.low) / (2 * step);
    std::vector<TrialPixel> result(size_t(blocks.x) * size_t(blocks.y) * TrialPixel::kPerBlock);
    context.progress.BeginPhase("trial", int64_t(result.size()));
    ParallelForEach(int64_t(result.size()) / TrialPixel::kPerBlock, [&](int64_t b) {
        IndependentSampler sampler({.samplesPerPixel = kSamples, .seed = int(Hash(kStream, context.seed))});
        const Point2i block(int(b % blocks.x), int(b / blocks.x));
        for (int i = 0; i < TrialPixel::kPerBlock && !context.progress.Cancelled(); ++i) {
            const Point2i pixel = bounds.low + (2 * block + Point2i(i % 2, i / 2)) * step + step / 2;
            result[size_t(b) * TrialPixel::kPerBlock + size_t(i)] = TracePixel(context, follow, pixel, sampler);
            context.progress.Advance();
        }
    });
    context.progress.EndPhase();
    if (context.progress.Cancelled()) result.clear();
    return result;
}

}  // namespace pbrt
