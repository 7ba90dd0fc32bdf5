#include "pbrt/integrators/render_loop.h"

#include "pbrt/core/parallel.h"
#include "pbrt/integrators/reference_log.h"
#include "pbrt/lightsamplers/light_learner.h"

namespace pbrt {

namespace {

using Clock = std::chrono::steady_clock;
double SecondsSince(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

}  // namespace

WaveRenderer::WaveRenderer(Integrator &integrator, const Camera &camera, const Filter &filter, Film &film,
                           const Sampler &sampler, const RenderSettings &settings, Progress &progress)
    : integrator_(integrator),
      learner_(integrator.Learner()),
      camera_(camera),
      filter_(filter),
      film_(film),
      sampler_(sampler),
      settings_(settings),
      progress_(progress),
      samplers_(static_cast<size_t>(ThreadCount())) {}

void WaveRenderer::LearnIfDue() {
    if (learner_ && learner_->NextLearning() > 0 && done_ == learner_->NextLearning()) learner_->Learn(progress_);
}

int WaveRenderer::Render(int count) {
    const int batch = settings_.samplesPerPixel;
    if (int round = done_ / batch; round != round_) {
        round_ = round;
        std::unique_ptr<Sampler> prototype = sampler_.ForBatch(round);
        for (std::unique_ptr<Sampler> &s : samplers_) s = prototype->Clone();
    }
    const int first = done_ - round_ * batch;
    int size = std::min(count, batch - first);
    LearnIfDue();
    if (learner_ && learner_->NextLearning() > 0) size = std::min(size, learner_->NextLearning() - done_);
    if (progress_.Cancelled()) return 0;
    const RenderPass pass{.camera = camera_,
                          .filter = filter_,
                          .film = film_,
                          .samplers = samplers_,
                          .samplesPerPixel = batch,
                          .batchFirst = round_ * batch,
                          .first = first,
                          .count = size,
                          .jittersPixels = !settings_.disablePixelJitter,
                          .jittersWavelengths = !settings_.disableWavelengthJitter,
                          .keepsSamples = !isRepeating_,
                          .isCounted = settings_.timeBudget <= 0,
                          .progress = progress_};
    if (!integrator_.Render(pass)) return 0;
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

RenderResult RenderWaves(Integrator &integrator, const Camera &camera, const Filter &filter, Film &film,
                         const Sampler &sampler, const RenderSettings &settings, Progress &progress) {
    RenderResult result;
    ReferenceLog reference(settings.mseReferenceImage, settings.mseReferenceOut, film);
    WaveRenderer renderer(integrator, camera, filter, film, sampler, settings, progress);
    const bool timed = settings.timeBudget > 0;

    progress.BeginPhase("rendering", timed ? 0 : int64_t{film.PixelBounds().Area()} * settings.samplesPerPixel);
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
        renderer.LearnIfDue();
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
