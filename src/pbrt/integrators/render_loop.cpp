#include "pbrt/integrators/render_loop.h"

#include <cstdio>

#include "pbrt/core/files.h"
#include "pbrt/core/parallel.h"
#include "pbrt/images/metrics.h"

namespace pbrt {

namespace {

constexpr int kTileSize = 16;
constexpr int kLargestWave = 64;

using Clock = std::chrono::steady_clock;
double SecondsSince(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

/// One camera path into one pixel.
class PixelSampler {
  public:
    PixelSampler(const Integrator &integrator, const Camera &camera, const Filter &filter, RgbFilm &film,
                 const RenderSettings &settings)
        : integrator_(integrator), camera_(camera), filter_(filter), film_(film), settings_(settings),
          differentialScale_(settings.disablePixelJitter
                                 ? Float(1)
                                 : std::max(Float(0.125), 1 / std::sqrt(static_cast<Float>(settings.samplesPerPixel)))) {}

    void operator()(Point2i pixel, int sampleIndex, Sampler &sampler) const {
        sampler.StartPixelSample(pixel, sampleIndex);
        Float uLambda = sampler.Get1D();
        SampledWavelengths lambda = film_.SampleWavelengths(settings_.disableWavelengthJitter ? Float(0.5) : uLambda);
        FilterSample offset = filter_.Sample(sampler.GetPixel2D());
        CameraSample cs;
        cs.pFilm = Point2(pixel) + Point2(0.5f, 0.5f) + offset.offset;
        cs.time = sampler.Get1D();
        cs.pLens = sampler.Get2D();
        cs.filterWeight = offset.weight;
        if (settings_.disablePixelJitter) cs = {Point2(pixel) + Point2(0.5f, 0.5f), {0.5f, 0.5f}, 0.5f, 1};
        SampledSpectrum L(0);
        if (std::optional<CameraRay> ray = camera_.GenerateRay(cs, lambda)) {
            SampledSpectrum weight = ray->weight;
            ray->differential.Scale(ray->ray, differentialScale_);
            L = weight * integrator_.Li(*ray, lambda, sampler);
        }
        film_.AddSample(pixel, L, lambda, cs.filterWeight);
    }

  private:
    const Integrator &integrator_;
    const Camera &camera_;
    const Filter &filter_;
    RgbFilm &film_;
    const RenderSettings &settings_;
    Float differentialScale_;
};

/// The reference of --mse-reference-image and the file that gets one "spp, mse" line per wave.
class ReferenceLog {
  public:
    ReferenceLog(const RenderSettings &settings, const RgbFilm &film) {
        if (settings.mseReferenceImage.empty()) return;
        ImageFile file = ReadImage(settings.mseReferenceImage);
        const Bounds2i &wanted = film.PixelBounds();
        Bounds2i have = file.metadata.pixelBounds.value_or(Bounds2i{{0, 0}, file.image.Resolution()});
        if (wanted.low.x < have.low.x || wanted.low.y < have.low.y || wanted.high.x > have.high.x || wanted.high.y > have.high.y)
            throw UserError(fmt::format("{}: the reference image covers x {}-{}, y {}-{}; the film needs x {}-{}, y {}-{}.",
                                        settings.mseReferenceImage, have.low.x, have.high.x, have.low.y, have.high.y,
                                        wanted.low.x, wanted.high.x, wanted.low.y, wanted.high.y));
        reference_ = file.image.Select({"R", "G", "B"}).Crop({wanted.low - have.low, wanted.high - have.low});
        out_.reset(std::fopen(settings.mseReferenceOut.c_str(), "w"));
        if (!out_) throw UserError(fmt::format("{}: cannot be written.", settings.mseReferenceOut));
    }
    std::optional<double> Log(int samples, const RgbFilm &film) {
        if (!reference_) return {};
        double mse = ImageError(film.ToImage(), reference_, Metric::MSE);
        std::fprintf(out_.get(), "%d, %.9g\n", samples, mse);
        std::fflush(out_.get());
        return mse;
    }

  private:
    struct Close {
        void operator()(std::FILE *f) const { std::fclose(f); }
    };
    Image reference_;
    std::unique_ptr<std::FILE, Close> out_;
};

}  // namespace

RenderResult RenderWaves(const Integrator &integrator, const Camera &camera, const Filter &filter, RgbFilm &film,
                         const std::function<std::unique_ptr<Sampler>(int)> &makeSampler, const RenderSettings &settings,
                         Progress &progress) {
    RenderResult result;
    ReferenceLog reference(settings, film);
    PixelSampler samplePixel(integrator, camera, filter, film, settings);
    const Bounds2i bounds = film.PixelBounds();
    const Vector2i tiles = (bounds.high - bounds.low + (kTileSize - 1)) / kTileSize;
    const int64_t tileCount = bounds.IsEmpty() ? 0 : int64_t(tiles.x) * tiles.y;
    const bool timed = settings.timeBudget > 0;

    progress.BeginPhase("rendering", timed ? 0 : tileCount * settings.samplesPerPixel);
    const Clock::time_point renderStart = Clock::now();

    // One sampler a thread and round; which thread takes which tile does not matter.
    std::vector<std::unique_ptr<Sampler>> samplers(static_cast<size_t>(ThreadCount()));
    int round = -1;
    auto startRound = [&](int r) {
        round = r;
        std::unique_ptr<Sampler> prototype = makeSampler(r);
        for (std::unique_ptr<Sampler> &s : samplers) s = prototype->Clone();
    };

    int wave = 1, done = 0;
    double lastWaveSeconds = 0;
    int lastWaveSamples = 0;
    while (!progress.Cancelled()) {
        int size = wave;
        if (timed) {
            double left = settings.timeBudget - SecondsSince(settings.start);
            if (done > 0) {
                double perSample = lastWaveSeconds / lastWaveSamples;
                // A wave that would end later than the budget is made smaller; below half a sample we stop.
                int fits = static_cast<int>(std::min(left / perSample, 1e6) + 0.5);
                if (fits < 1) break;
                size = std::min(size, fits);
            }
            if (done / settings.samplesPerPixel != round) startRound(done / settings.samplesPerPixel);
            size = std::min(size, (round + 1) * settings.samplesPerPixel - done);
        } else {
            if (done >= settings.samplesPerPixel) break;
            if (round < 0) startRound(0);
            size = std::min(size, settings.samplesPerPixel - done);
        }
        const int first = done - round * settings.samplesPerPixel;
        const Clock::time_point waveStart = Clock::now();
        ParallelForEach(tileCount, [&](int64_t tile) {
            if (progress.Cancelled()) return;
            Sampler &sampler = *samplers[static_cast<size_t>(ThreadIndex())];
            Point2i low = bounds.low + kTileSize * Point2i(static_cast<int>(tile % tiles.x), static_cast<int>(tile / tiles.x));
            Point2i high = glm::min(low + kTileSize, bounds.high);
            for (int y = low.y; y < high.y; ++y)
                for (int x = low.x; x < high.x; ++x)
                    for (int i = first; i < first + size; ++i) samplePixel({x, y}, i, sampler);
            if (!timed) progress.Advance(size);
        });
        if (progress.Cancelled()) break;
        done += size;
        lastWaveSeconds = SecondsSince(waveStart);
        lastWaveSamples = size;
        result.mse = reference.Log(done, film);
        if (timed) {
            double spent = SecondsSince(settings.start);
            progress.SetFraction(spent / settings.timeBudget, settings.timeBudget - spent);
        }
        if (settings.afterWave) settings.afterWave(done);
        if (done > 1 || !timed) wave = std::min(2 * wave, kLargestWave);
        if (done == 1) wave = 1;
    }
    result.samplesTaken = done;
    result.cancelled = progress.Cancelled();
    result.seconds = SecondsSince(renderStart);
    progress.EndPhase();
    return result;
}

}  // namespace pbrt
