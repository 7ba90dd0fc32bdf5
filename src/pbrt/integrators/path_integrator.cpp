#include "pbrt/integrators/path_integrator.h"

#include <array>

#include "pbrt/core/counters.h"
#include "pbrt/core/parallel.h"
#include "pbrt/integrators/camera_path.h"

namespace pbrt {
namespace {

constexpr int kGroup = 8;  ///< samples of a pixel, twice
constexpr double kShare = 0.015, kMaxShare = 0.03;
constexpr double kMinPixels = 256, kMaxPixels = 4096;
constexpr uint64_t kStream = 0x747269616c;

using FollowPath = std::function<SampledSpectrum(const CameraPathStart &, SampledWavelengths &, Sampler &)>;

/// Radiance of a sample, mean over wavelengths; 0 if invalid.
double TraceSample(const PrepareContext &context, const FollowPath &follow, Point2i pixel, int index,
                   Sampler &sampler) {
    sampler.StartPixelSample(pixel, index);
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(sampler.Get1D());
    const CameraSample cs = SampleCamera(context.filter, pixel, sampler);
    const std::optional<CameraRay> ray = context.camera.GenerateRay(cs, lambda);
    if (!ray) return 0;
    const SampledSpectrum L =
        ray->weight * follow({*ray, pixel, std::numeric_limits<int>::max() - index}, lambda, sampler);
    const double value = double(L.Average() * cs.filterWeight);
    return std::isfinite(value) ? value : 0;
}

/// `samplers`: two of the render's kind, with seeds of their own. Their means over kGroup samples, which are as well
/// distributed as the render's, give the variance.
TrialPixel TracePixel(const PrepareContext &context, const FollowPath &follow, Point2i pixel,
                      std::span<const std::unique_ptr<Sampler>, 2> samplers) {
    RenderCounters &counters = ThreadCounters();
    const RenderCounters before = counters;
    double mean[2] = {};
    for (size_t k = 0; k < 2; ++k)
        for (int i = 0; i < kGroup; ++i) mean[k] += TraceSample(context, follow, pixel, i, *samplers[k]) / kGroup;
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

/// False if a trial would take more than kMaxShare of the render's samples.
bool IsLongEnough(const PrepareContext &context) { return kMinPixels * 2 * kGroup <= kMaxShare * SamplesOf(context); }

/// PrepareContext::trial: two groups of samples of pixels in a regular pattern, about kShare of the render's samples,
/// by `follow`. Their numbers are no pixel sample's, the film does not get them, and the statistics do not count them.
/// The result depends on neither threads nor processes.
std::vector<TrialPixel> TraceTrial(const PrepareContext &context, const FollowPath &follow) {
    const Bounds2i &bounds = context.pixelBounds;
    const double wanted = std::clamp(kShare * SamplesOf(context) / (2 * kGroup), kMinPixels, kMaxPixels);
    // Pixels at equal steps, in blocks of two by two.
    const int step = std::max(1, int(std::sqrt(double(bounds.Area()) / wanted)));
    const Vector2i blocks = (bounds.high - bounds.low) / (2 * step);
    std::vector<TrialPixel> result(size_t(blocks.x) * blocks.y * TrialPixel::kPerBlock);
    context.progress.BeginPhase("trial", int64_t(result.size()));
    ParallelForEach(int64_t(result.size()) / TrialPixel::kPerBlock, [&](int64_t b) {
        std::array<std::unique_ptr<Sampler>, 2> samplers;
        for (size_t k = 0; k < 2; ++k) samplers[k] = context.sampler.WithSeed(int(Hash(kStream, context.seed, k)));
        const Point2i block(int(b % blocks.x), int(b / blocks.x));
        for (int i = 0; i < TrialPixel::kPerBlock && !context.progress.Cancelled(); ++i) {
            const Point2i pixel = bounds.low + (2 * block + Point2i(i % 2, i / 2)) * step + step / 2;
            result[b * TrialPixel::kPerBlock + i] = TracePixel(context, follow, pixel, samplers);
            context.progress.Advance();
        }
    });
    context.progress.EndPhase();
    if (context.progress.Cancelled()) result.clear();
    return result;
}

}  // namespace

PathIntegrator::PathIntegrator(const PathContext &context, const PathSettings &settings,
                               std::unique_ptr<LightSampler> lights, std::unique_ptr<DirectionSampling> directions)
    : context_(context), settings_(settings), lights_(std::move(lights)), directions_(std::move(directions)),
      setup_{context_, settings_, *lights_, lights_->Observer()}, models_{lights_->Model(), directions_.get()} {}

SampledSpectrum PathIntegrator::Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const {
    if (directions_) return directions_->Li(setup_, start, lambda, sampler);
    return FollowBsdf(start, lambda, sampler);
}

SampledSpectrum PathIntegrator::FollowBsdf(const CameraPathStart &start, SampledWavelengths &lambda,
                                           Sampler &sampler) const {
    BsdfDirections bsdf;
    if (settings_.tracksMedia)
        return CameraPath<MediaThroughput, BsdfDirections>(setup_, start, lambda, sampler, bsdf).Follow();
    return CameraPath<SurfaceThroughput, BsdfDirections>(setup_, start, lambda, sampler, bsdf).Follow();
}

void PathIntegrator::Prepare(PrepareContext &prepare) {
    const FollowPath follow = [this](const CameraPathStart &start, SampledWavelengths &lambda, Sampler &sampler) {
        return FollowBsdf(start, lambda, sampler);
    };
    if (IsLongEnough(prepare)) prepare.trial = [&] { return TraceTrial(prepare, follow); };
    lights_->Prepare(prepare);
    prepare.trial = {};
    if (directions_) directions_->Prepare(prepare, settings_.maxDepth);
}

}  // namespace pbrt
