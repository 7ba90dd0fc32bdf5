#include "pbrt/integrators/render_loop.h"

#include "pbrt/core/online_model.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/ranks.h"
#include "pbrt/integrators/reference_log.h"

namespace pbrt {

namespace {

using Clock = std::chrono::steady_clock;
double SecondsSince(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

}  // namespace

WaveRenderer::WaveRenderer(Integrator &integrator, const Camera &camera, const Filter &filter, Film &film,
                           const Sampler &sampler, const RenderSettings &settings, Progress &progress)
    : integrator_(integrator),
      model_(integrator.Model()),
      camera_(camera),
      filter_(filter),
      film_(film),
      sampler_(sampler),
      settings_(settings),
      progress_(progress),
      samplers_(static_cast<size_t>(ThreadCount())) {}

void WaveRenderer::LearnIfDue() {
    if (!model_ || model_->NextUpdate() == 0 || Done() != model_->NextUpdate()) return;
    if (settings_.ranks) {
        if (progress_.Cancelled()) return;
        Say(Command::Learn);
        LearnTogether();
    } else {
        model_->Update(progress_);
    }
}

int WaveRenderer::Render(int count) {
    const int batch = settings_.samplesPerPixel;
    int size = std::min({count, batch - Done() % batch, integrator_.MaxPassSamples()});
    LearnIfDue();
    if (model_ && model_->NextUpdate() > 0) size = std::min(size, model_->NextUpdate() - Done());
    if (progress_.Cancelled()) return 0;
    // What is left of a pass that was cancelled comes first.
    if (position_.passCount > 0) size = position_.passCount;
    position_.passCount = size;
    if (settings_.ranks) Say(Command::Pass);
    return RenderPassOf(size) ? size : 0;
}

bool WaveRenderer::RenderPassOf(int size) {
    const int batch = settings_.samplesPerPixel;
    if (int round = Done() / batch; round != round_) {
        round_ = round;
        std::unique_ptr<Sampler> prototype = sampler_.ForBatch(round);
        for (std::unique_ptr<Sampler> &s : samplers_) s = prototype->Clone();
    }
    const RenderPass pass{.camera = camera_,
                          .filter = filter_,
                          .film = film_,
                          .samplers = samplers_,
                          .samplesPerPixel = batch,
                          .batchFirst = round_ * batch,
                          .first = Done() - round_ * batch,
                          .count = size,
                          .jittersPixels = !settings_.disablePixelJitter,
                          .jittersWavelengths = !settings_.disableWavelengthJitter,
                          .keepsSamples = !isRepeating_,
                          .isCounted = settings_.timeBudget <= 0 && !isRepeating_,
                          .done = &position_.passDone,
                          .doneFile = position_.file,
                          .progress = progress_,
                          .ranks = settings_.ranks};
    if (!integrator_.Render(pass)) return false;
    position_ = {.done = Done() + size};
    return true;
}

void WaveRenderer::ContinueFrom(int samples) {
    isRepeating_ = true;
    while (model_ && model_->NextUpdate() > 0 && Done() < samples)
        if (Render(samples - Done()) == 0) break;
    isRepeating_ = false;
    position_ = {.done = samples};
}

void WaveRenderer::Say(Command command) {
    StateWriter out;
    out.Value(command);
    if (command == Command::Pass) {
        out.Value(position_.done);
        out.Value(position_.passCount);
        out.Value(isRepeating_);
        out.CopyOfVector(position_.passDone);
    }
    settings_.ranks->Broadcast(out);
}

void WaveRenderer::GatherHere() {
    const bool learns = model_ && model_->NextUpdate() > 0 && !isBrokenOff_;
    settings_.ranks->Reduce(
        [&](StateWriter &out) {
            film_.TakeSums(out);
            if (learns) model_->ExtractRecords(out);
        },
        [&](StateReader &in) {
            film_.AddSums(in);
            if (learns) model_->MergeRecords(in);
        });
}

void WaveRenderer::LearnTogether() {
    // To the first, and from there to all, so that everybody learns the same.
    settings_.ranks->Reduce([&](StateWriter &out) { model_->ExtractRecords(out); },
                            [&](StateReader &in) { model_->MergeRecords(in); });
    StateWriter all;
    if (settings_.ranks->IsFirst()) model_->ExtractRecords(all);
    const std::string found = settings_.ranks->Broadcast(all);
    StateReader in(found, "what was found");
    model_->MergeRecords(in);
    const int before = model_->NextUpdate();
    model_->Update(progress_);
    // Whoever was cancelled meanwhile has not learned; then nobody renders on.
    bool haveAllLearned = model_->NextUpdate() != before;
    settings_.ranks->Reduce([&](StateWriter &out) { out.Value(haveAllLearned); },
                            [&](StateReader &other) { haveAllLearned = other.Value<bool>() && haveAllLearned; });
    StateWriter verdict;
    verdict.Value(haveAllLearned);
    const std::string answer = settings_.ranks->Broadcast(verdict);
    if (StateReader(answer, "message").Value<bool>()) return;
    isBrokenOff_ = true;
    progress_.Cancel();
}

void WaveRenderer::Gather() {
    if (!settings_.ranks) return;
    Say(Command::Gather);
    GatherHere();
}

void WaveRenderer::EndTogether() {
    if (settings_.ranks) Say(Command::End);
}

void WaveRenderer::Follow() {
    for (;;) {
        const std::string said = settings_.ranks->Broadcast({});
        StateReader in(said, "command");
        switch (in.Value<Command>()) {
            case Command::Pass:
                in.Value(&position_.done);
                in.Value(&position_.passCount);
                in.Value(&isRepeating_);
                in.Vector(&position_.passDone);
                RenderPassOf(position_.passCount);
                break;
            case Command::Learn:
                LearnTogether();
                break;
            case Command::Gather:
                GatherHere();
                break;
            case Command::End:
                return;
        }
    }
}

void FollowWaves(Integrator &integrator, const Camera &camera, const Filter &filter, Film &film, const Sampler &sampler,
                 const RenderSettings &settings, Progress &progress) {
    progress.BeginPhase("rendering", 0);
    WaveRenderer(integrator, camera, filter, film, sampler, settings, progress).Follow();
    progress.EndPhase();
}

RenderResult RenderWaves(Integrator &integrator, const Camera &camera, const Filter &filter, Film &film,
                         const Sampler &sampler, const RenderSettings &settings, Progress &progress) {
    RenderResult result;
    ReferenceLog reference(settings.mseReferenceImage, settings.mseReferenceOut, film);
    WaveRenderer renderer(integrator, camera, filter, film, sampler, settings, progress);
    const bool timed = settings.timeBudget > 0;
    const int end = settings.EndSample();
    const int64_t pixels = film.PixelBounds().Area();

    progress.BeginPhase("rendering", timed ? 0 : pixels * (end - settings.firstSample));
    const Clock::time_point renderStart = Clock::now();
    if (settings.from) {
        renderer.GoOnFrom(*settings.from);
        if (!timed) progress.Advance(pixels * (renderer.Done() - settings.firstSample));
        for (uint32_t done : settings.from->passDone)
            if (!timed) progress.Advance(done);
    } else if (settings.firstSample > 0) {
        renderer.ContinueFrom(settings.firstSample);
    }
    // Preparing the lights may have taken long; a render that goes on has just read what it would save.
    Clock::time_point saved = settings.from ? renderStart : settings.start;
    const bool isPrepared = !progress.Cancelled();
    const auto saveIfDue = [&] {
        if (!settings.checkpoint || SecondsSince(saved) < settings.checkpointInterval) return;
        renderer.Gather();
        settings.checkpoint(renderer.Position());
        saved = Clock::now();
    };
    if (isPrepared) saveIfDue();
    const int largest = kMaxWave * (settings.ranks ? settings.ranks->Size() : 1);
    int wave = 1;
    double secondsPerSample = settings.secondsPerSample;
    while (!progress.Cancelled() && (timed || renderer.Done() < end)) {
        int size = timed ? wave : std::min(wave, end - renderer.Done());
        if (timed && secondsPerSample > 0) {
            // A wave that would end later than the budget is made smaller; below half a sample we stop.
            double left = settings.timeBudget - SecondsSince(settings.start);
            int fits = static_cast<int>(std::min(left / secondsPerSample, 1e6) + 0.5);
            if (fits < 1) break;
            size = std::min(size, fits);
        }
        if (settings.checkpoint && secondsPerSample > 0)
            size = static_cast<int>(
                std::clamp(settings.checkpointInterval / secondsPerSample, 1.0, static_cast<double>(size)));
        if (settings.maxWaveSeconds > 0 && secondsPerSample > 0)
            size = static_cast<int>(
                std::clamp(settings.maxWaveSeconds / secondsPerSample, 1.0, static_cast<double>(size)));
        renderer.LearnIfDue();
        const Clock::time_point waveStart = Clock::now();
        const int taken = renderer.Render(size);
        if (taken == 0) break;
        secondsPerSample = SecondsSince(waveStart) / taken;
        if (settings.afterWave || reference.IsKept()) renderer.Gather();
        result.mse = reference.Log(renderer.Done(), film);
        if (timed) {
            double spent = SecondsSince(settings.start);
            progress.SetFraction(spent / settings.timeBudget, settings.timeBudget - spent);
        }
        if (settings.afterWave) settings.afterWave(renderer.Done());
        if (timed || renderer.Done() < end) saveIfDue();
        if (renderer.Done() > 1) wave = std::min(2 * wave, largest);
    }
    renderer.Gather();
    result.mseFailure = reference.Finish();
    result.samplesTaken = renderer.Done();
    result.cancelled = progress.Cancelled() && (timed || renderer.Done() < end);
    if (settings.checkpoint && isPrepared) settings.checkpoint(renderer.Position());
    renderer.EndTogether();
    result.seconds = SecondsSince(renderStart);
    progress.EndPhase();
    return result;
}

}  // namespace pbrt
