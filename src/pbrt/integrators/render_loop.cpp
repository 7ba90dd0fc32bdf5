#include "pbrt/integrators/render_loop.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "pbrt/core/files.h"
#include "pbrt/core/parallel.h"
#include "pbrt/films/gbuffer_film.h"
#include "pbrt/films/spectral_film.h"
#include "pbrt/images/metrics.h"
#include "pbrt/lightsamplers/light_learner.h"

namespace pbrt {

namespace {

constexpr int kTileSize = 16;
constexpr int kLargestWave = 64;

using Clock = std::chrono::steady_clock;
double SecondsSince(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

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
        name_ = settings.mseReferenceOut;
        out_.reset(std::fopen(name_.c_str(), "w"));
        if (!out_) throw UserError(fmt::format("{}: cannot be written: {}.", name_, std::strerror(errno)));
    }
    std::optional<double> Log(int samples, const RgbFilm &film) {
        if (!reference_) return {};
        Image image = film.ToImage();
        if (image.ChannelCount() > 3) image = image.Select({"R", "G", "B"});
        double mse = ImageError(image, reference_, Metric::MSE);
        // The render is worth more than its log: it goes on without it.
        if (out_ && (std::fprintf(out_.get(), "%d, %.9g\n", samples, mse) < 0 || std::fflush(out_.get()) != 0)) {
            Fail();
            out_.reset();
        }
        return mse;
    }
    /// Closes the file. Why it is not complete; empty if it is.
    const std::string &Finish() {
        // Some file systems tell only now.
        if (out_ && std::fclose(out_.release()) != 0) Fail();
        return failure_;
    }

  private:
    struct Close {
        void operator()(std::FILE *f) const { std::fclose(f); }
    };
    void Fail() { failure_ = fmt::format("{}: cannot be written: {}.", name_, std::strerror(errno)); }
    Image reference_;
    std::string name_, failure_;
    std::unique_ptr<std::FILE, Close> out_;
};

}  // namespace

WaveRenderer::WaveRenderer(Integrator &integrator, const Camera &camera, const Filter &filter, RgbFilm &film,
                           SamplerFactory makeSampler, const RenderSettings &settings, Progress &progress)
    : integrator_(integrator), learner_(integrator.Learner()), camera_(camera), filter_(filter), film_(film), makeSampler_(std::move(makeSampler)),
      settings_(settings), progress_(progress),
      differentialScale_(settings.disablePixelJitter
                             ? Float(1)
                             : std::max(Float(0.125), 1 / std::sqrt(static_cast<Float>(settings.samplesPerPixel)))),
      bounds_(film.PixelBounds()), tiles_((bounds_.high - bounds_.low + (kTileSize - 1)) / kTileSize),
      tileCount_(bounds_.IsEmpty() ? 0 : int64_t(tiles_.x) * tiles_.y), samplers_(static_cast<size_t>(ThreadCount())) {}

template <class Film>
void WaveRenderer::SamplePixel(Film &film, Point2i pixel, int sampleIndex, Sampler &sampler) const {
    sampler.StartPixelSample(pixel, sampleIndex);
    Float uLambda = sampler.Get1D();
    SampledWavelengths lambda = film.SampleWavelengths(settings_.disableWavelengthJitter ? Float(0.5) : uLambda);
    FilterSample offset = filter_.Sample(sampler.GetPixel2D());
    CameraSample cs;
    cs.pFilm = Point2(pixel) + Point2(0.5f, 0.5f) + offset.offset;
    cs.time = sampler.Get1D();
    cs.pLens = sampler.Get2D();
    cs.filterWeight = offset.weight;
    if (settings_.disablePixelJitter) cs = {Point2(pixel) + Point2(0.5f, 0.5f), {0.5f, 0.5f}, 0.5f, 1};
    SampledSpectrum L(0);
    [[maybe_unused]] std::optional<VisibleSurface> visible;
    if (std::optional<CameraRay> ray = camera_.GenerateRay(cs, lambda)) {
        SampledSpectrum weight = ray->weight;
        ray->differential.Scale(ray->ray, differentialScale_);
        if constexpr (std::is_same_v<Film, GBufferFilm>) visible = film.Look(*ray, lambda);
        L = weight * integrator_.Li({*ray, pixel, round_ * settings_.samplesPerPixel + sampleIndex}, lambda, sampler);
    }
    if (isRepeating_) return;
    if constexpr (std::is_same_v<Film, GBufferFilm>) film.AddSample(pixel, L, lambda, cs.filterWeight, visible);
    else film.AddSample(pixel, L, lambda, cs.filterWeight);
}

template <class Film>
bool WaveRenderer::RenderTile(Film &film, int64_t tile, int first, int size, Sampler &sampler) const {
    Point2i low = bounds_.low + kTileSize * Point2i(static_cast<int>(tile % tiles_.x), static_cast<int>(tile / tiles_.x));
    Point2i high = glm::min(low + kTileSize, bounds_.high);
    for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; ++x)
            for (int i = first; i < first + size; ++i) {
                // Asked before every sample: one alone may take a tenth of a second.
                if (progress_.Cancelled()) return false;
                SamplePixel(film, {x, y}, i, sampler);
            }
    return true;
}

int WaveRenderer::Render(int count) {
    if (int round = done_ / settings_.samplesPerPixel; round != round_) {
        round_ = round;
        std::unique_ptr<Sampler> prototype = makeSampler_(round);
        for (std::unique_ptr<Sampler> &s : samplers_) s = prototype->Clone();
    }
    const int first = done_ - round_ * settings_.samplesPerPixel;
    int size = std::min(count, settings_.samplesPerPixel - first);
    if (learner_ && learner_->NextLearning() > 0) {
        if (done_ == learner_->NextLearning()) learner_->Learn(progress_);
        if (const int next = learner_->NextLearning(); next > 0) size = std::min(size, next - done_);
    }
    if (progress_.Cancelled()) return 0;
    std::atomic<bool> isWhole = true;
    ParallelForEach(tileCount_, [&](int64_t tile) {
        bool finished = false;
        // Which thread takes which tile does not matter.
        Sampler &sampler = *samplers_[static_cast<size_t>(ThreadIndex())];
        switch (film_.Kind()) {
            case FilmKind::Rgb: finished = RenderTile(film_, tile, first, size, sampler); break;
            case FilmKind::GBuffer: finished = RenderTile(static_cast<GBufferFilm &>(film_), tile, first, size, sampler); break;
            case FilmKind::Spectral: finished = RenderTile(static_cast<SpectralFilm &>(film_), tile, first, size, sampler); break;
        }
        if (!finished) isWhole.store(false, std::memory_order_relaxed);
        else if (settings_.timeBudget <= 0) progress_.Advance(size);
    });
    if (!isWhole) return 0;
    done_ += size;
    return size;
}

void WaveRenderer::ContinueFrom(int samples) {
    isRepeating_ = true;
    while (learner_ && learner_->NextLearning() > 0 && done_ < samples)
        if (Render(samples - done_) == 0) break;
    isRepeating_ = false;
    done_ = samples;
}

RenderResult RenderWaves(Integrator &integrator, const Camera &camera, const Filter &filter, RgbFilm &film,
                         const SamplerFactory &makeSampler, const RenderSettings &settings, Progress &progress) {
    RenderResult result;
    ReferenceLog reference(settings, film);
    WaveRenderer renderer(integrator, camera, filter, film, makeSampler, settings, progress);
    const bool timed = settings.timeBudget > 0;

    progress.BeginPhase("rendering", timed ? 0 : renderer.TileCount() * settings.samplesPerPixel);
    const Clock::time_point renderStart = Clock::now();
    int wave = 1;
    double secondsPerSample = 0;
    while (timed || renderer.Done() < settings.samplesPerPixel) {
        int size = wave;
        if (timed && renderer.Done() > 0) {
            // A wave that would end later than the budget is made smaller; below half a sample we stop.
            double left = settings.timeBudget - SecondsSince(settings.start);
            int fits = static_cast<int>(std::min(left / secondsPerSample, 1e6) + 0.5);
            if (fits < 1) break;
            size = std::min(size, fits);
        }
        const Clock::time_point waveStart = Clock::now();
        const int taken = renderer.Render(size);
        if (taken == 0) break;
        secondsPerSample = SecondsSince(waveStart) / taken;
        result.mse = reference.Log(renderer.Done(), film);
        if (timed) {
            double spent = SecondsSince(settings.start);
            progress.SetFraction(spent / settings.timeBudget, settings.timeBudget - spent);
        }
        if (settings.afterWave) settings.afterWave(renderer.Done());
        if (renderer.Done() > 1) wave = std::min(2 * wave, kLargestWave);
    }
    result.mseFailure = reference.Finish();
    result.samplesTaken = renderer.Done();
    result.cancelled = progress.Cancelled() && (timed || renderer.Done() < settings.samplesPerPixel);
    result.seconds = SecondsSince(renderStart);
    progress.EndPhase();
    return result;
}

}  // namespace pbrt
