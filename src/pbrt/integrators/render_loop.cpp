#include "pbrt/integrators/render_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pbrt/core/online_model.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/progress.h"
#include "pbrt/integrators/reference_log.h"

namespace pbrt {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

WaveRenderer::WaveRenderer(const RenderContext &context, const RenderSettings &settings)
    : context_(context), model_(context.integrator.Model()), settings_(settings), samplers_(ThreadCount()),
      oddSamplers_(context.half ? ThreadCount() : 0) {
    if (context.half) position_.plan.cost.resize(PixelCells(context.film.PixelBounds()).Count());
}

void WaveRenderer::UpdateIfDue() {
    if (!model_ || model_->NextUpdate() == 0 || Done() != model_->NextUpdate() || context_.progress.Cancelled()) return;
    Send(Command::Update);
    UpdateTogether();
}

void WaveRenderer::DecideIfDue() {
    SamplePlan &plan = position_.plan;
    // A resumed render estimates the noise anew, and plans the same from the same sums.
    const bool isDue = Done() == plan.end || (!isDecided_ && Done() == plan.begin);
    if (!context_.half || position_.passCount > 0 || !isDue) return;
    UpdateIfDue();
    if (context_.progress.Cancelled()) return;
    isDecided_ = true;
    const int uniform = std::max(PilotSamples(settings_.samplesPerPixel), model_ ? model_->NextUpdate() : 0);
    if (Done() < uniform) {
        plan.begin = Done();
        plan.end = uniform;
    } else {
        Gather();
        const NoiseEstimate estimate = EstimateNoise(context_.film, *context_.half, plan, Done()).value();
        noise_ = std::sqrt(estimate.relL2);
        int end = NextDecision(Done(), settings_.samplesPerPixel);
        if (settings_.noise > 0) {
            const double enough = std::ceil(SamplesForNoise(Done(), *noise_, settings_.noise));
            end = int(std::clamp(enough, std::min(Done() + 2.0, double(end)), double(end)));
        }
        plan = AllocateSamples(PixelCells(context_.film.PixelBounds()), plan, estimate.variance, Done(), end);
    }
    Send(Command::Plan);
}

int WaveRenderer::Render(int count) {
    const int batch = settings_.samplesPerPixel;
    DecideIfDue();
    const int left = context_.half ? position_.plan.end - Done() : batch - Done() % batch;
    int size = std::min({count, left, context_.integrator.MaxPassSamples()});
    UpdateIfDue();
    if (model_ && model_->NextUpdate() > 0) size = std::min(size, model_->NextUpdate() - Done());
    if (context_.progress.Cancelled()) return 0;
    // The rest of a cancelled pass comes first.
    if (position_.passCount > 0) size = position_.passCount;
    position_.passCount = size;
    Send(Command::Pass);
    return RenderPassOf(size) ? size : 0;
}

bool WaveRenderer::RenderPassOf(int size) {
    const int batch = settings_.samplesPerPixel;
    if (int round = context_.half ? 0 : Done() / batch; round != round_) {
        round_ = round;
        const auto fill = [&](std::vector<std::unique_ptr<Sampler>> &samplers, int index) {
            const std::unique_ptr<Sampler> prototype = context_.sampler.ForBatch(index);
            for (std::unique_ptr<Sampler> &s : samplers) s = prototype->Clone();
        };
        fill(samplers_, round);
        if (context_.half) fill(oddSamplers_, 1);
    }
    std::optional<AdaptivePass> adaptive;
    if (context_.half)
        adaptive.emplace(AdaptivePass{position_.plan, *context_.half, settings_.noise > 0 ? oddSamplers_ : samplers_,
                                      position_.plan.cost});
    const RenderPass pass{.camera = context_.camera,
                          .filter = context_.filter,
                          .film = context_.film,
                          .samplers = samplers_,
                          .samplesPerPixel = batch,
                          .batchFirst = round_ * batch,
                          .first = Done() - round_ * batch,
                          .count = size,
                          .jittersPixels = !settings_.disablePixelJitter,
                          .jittersWavelengths = !settings_.disableWavelengthJitter,
                          .keepsSamples = !isRepeating_,
                          .isCounted = settings_.HasKnownEnd() && !isRepeating_,
                          .done = &position_.passDone,
                          .doneFile = position_.file,
                          .progress = context_.progress,
                          .adaptive = adaptive ? &*adaptive : nullptr,
                          .team = context_.team};
    if (!context_.integrator.Render(pass)) return false;
    position_ = {.done = Done() + size, .plan = std::move(position_.plan)};
    return true;
}

void WaveRenderer::ContinueFrom(int samples) {
    isRepeating_ = true;
    while (model_ && model_->NextUpdate() > 0 && Done() < samples)
        if (Render(samples - Done()) == 0) break;
    isRepeating_ = false;
    position_ = {.done = samples};
}

void WaveRenderer::Send(Command command) {
    StateWriter out;
    out.Value(command);
    if (command == Command::Pass) out(position_.done, position_.passCount, isRepeating_, position_.passDone);
    if (command == Command::Plan) out(position_.plan);
    context_.team.Broadcast(out);
}

void WaveRenderer::TakeAdaptive(StateWriter &out) {
    context_.half->TakeSums(out);
    for (uint64_t &cost : position_.plan.cost) out.Value(std::exchange(cost, 0));
}

void WaveRenderer::AddAdaptive(StateReader &in) {
    context_.half->AddSums(in);
    for (uint64_t &cost : position_.plan.cost) cost += in.Value<uint64_t>();
}

void WaveRenderer::GatherHere() {
    const bool learns = model_ && model_->NextUpdate() > 0 && !isBrokenOff_;
    context_.team.Reduce(
        [&](StateWriter &out) {
            context_.film.TakeSums(out);
            if (context_.half) TakeAdaptive(out);
            if (learns) model_->ExtractRecords(out);
        },
        [&](StateReader &in) {
            context_.film.AddSums(in);
            if (context_.half) AddAdaptive(in);
            if (learns) model_->MergeRecords(in);
        });
}

void WaveRenderer::UpdateTogether() {
    Team &team = context_.team;
    // All models are updated from the same records.
    team.AllReduce([&](StateWriter &out) { model_->ExtractRecords(out); },
                   [&](StateReader &in) { model_->MergeRecords(in); });
    const int before = model_->NextUpdate();
    model_->Update(context_.progress);
    // A process cancelled meanwhile has its old model; all processes then stop.
    bool areAllUpdated = model_->NextUpdate() != before;
    team.Reduce([&](StateWriter &out) { out.Value(areAllUpdated); },
                [&](StateReader &in) { areAllUpdated = in.Value<bool>() && areAllUpdated; });
    if (team.BroadcastValue(areAllUpdated)) return;
    isBrokenOff_ = true;
    context_.progress.Cancel();
}

void WaveRenderer::Gather() {
    Send(Command::Gather);
    GatherHere();
}

void WaveRenderer::EndTogether() { Send(Command::End); }

void WaveRenderer::Follow() {
    for (;;) {
        const std::string command = context_.team.Broadcast({});
        StateReader in(command, "command");
        switch (in.Value<Command>()) {
            case Command::Pass:
                in(position_.done, position_.passCount, isRepeating_, position_.passDone);
                RenderPassOf(position_.passCount);
                break;
            case Command::Update: UpdateTogether(); break;
            case Command::Plan: {
                // Rank 0 has the cost up to the last Gather, this process its own since then.
                std::vector<uint64_t> cost = std::move(position_.plan.cost);
                in(position_.plan);
                position_.plan.cost = std::move(cost);
                break;
            }
            case Command::Gather: GatherHere(); break;
            case Command::End: return;
        }
    }
}

void FollowWaves(const RenderContext &context, const RenderSettings &settings) {
    context.progress.BeginPhase("rendering", 0);
    WaveRenderer(context, settings).Follow();
    context.progress.EndPhase();
}

namespace {

class WaveLoop {
  public:
    WaveLoop(const RenderContext &context, const RenderSettings &settings)
        : context_(context), settings_(settings),
          reference_(settings.mseReferenceImage, settings.mseReferenceOut, context.film), renderer_(context, settings),
          secondsPerSample_(settings.secondsPerSample) {}

    RenderResult Run() {
        Progress &progress = context_.progress;
        Begin();
        renderer_.DecideIfDue();
        const bool isPrepared = !progress.Cancelled();
        if (isPrepared) SaveIfDue();
        const int largest = kMaxWave * context_.team.Size();
        for (int wave = 1; !IsDone() && !progress.Cancelled();) {
            const int size = SizeOf(wave);
            if (size < 1 || !RenderWave(size)) break;
            if (!IsDone()) SaveIfDue();
            if (renderer_.Done() > 1) wave = std::min(2 * wave, largest);
        }
        renderer_.Gather();
        result_.mseFailure = reference_.Finish();
        result_.cancelled = progress.Cancelled() && !IsDone();
        Describe();
        if (settings_.checkpoint && isPrepared) settings_.checkpoint(renderer_.Position(), result_);
        renderer_.EndTogether();
        result_.seconds = SecondsSince(start_);
        progress.EndPhase();
        return result_;
    }

  private:
    bool IsTimed() const { return settings_.timeBudget > 0; }
    bool IsDone() const {
        if (settings_.noise > 0 && renderer_.Noise() && *renderer_.Noise() <= settings_.noise) return true;
        return !IsTimed() && renderer_.Done() >= settings_.EndSample();
    }
    /// Updates the result. The films are gathered.
    void Describe() {
        result_.samplesTaken = renderer_.Done();
        if (context_.half)
            result_.adaptive =
                DescribeAdaptive(context_.film, *context_.half, renderer_.Position().plan, renderer_.Done());
    }

    void Begin() {
        Progress &progress = context_.progress;
        const int64_t pixels = context_.film.PixelBounds().Area();
        progress.BeginPhase("rendering",
                            settings_.HasKnownEnd() ? pixels * (settings_.EndSample() - settings_.firstSample) : 0);
        start_ = Clock::now();
        // Light preparation may have taken long; a resumed render has just loaded its checkpoint.
        saved_ = settings_.from ? start_ : settings_.start;
        if (settings_.from) {
            renderer_.GoOnFrom(*settings_.from);
            if (!settings_.HasKnownEnd()) return;
            progress.Advance(pixels * (renderer_.Done() - settings_.firstSample));
            for (uint32_t done : settings_.from->passDone) progress.Advance(done);
        } else if (settings_.firstSample > 0) {
            renderer_.ContinueFrom(settings_.firstSample);
        }
    }

    void SaveIfDue() {
        if (!settings_.checkpoint || SecondsSince(saved_) < settings_.checkpointInterval) return;
        renderer_.Gather();
        Describe();
        settings_.checkpoint(renderer_.Position(), result_);
        saved_ = Clock::now();
    }

    /// Samples per pixel of the next wave, at most `wave`; 0 if less than half a sample fits the time budget.
    int SizeOf(int wave) const {
        int size = IsTimed() ? wave : std::min(wave, settings_.EndSample() - renderer_.Done());
        if (!(secondsPerSample_ > 0)) return size;
        if (IsTimed()) {
            const double left = settings_.timeBudget - SecondsSince(settings_.start);
            const int fits = int(std::min(left / secondsPerSample_, 1e6) + 0.5);
            if (fits < 1) return 0;
            size = std::min(size, fits);
        }
        const auto limit = [&](double seconds) {
            size = int(std::clamp(seconds / secondsPerSample_, 1.0, double(size)));
        };
        if (settings_.checkpoint) limit(settings_.checkpointInterval);
        if (settings_.maxWaveSeconds > 0) limit(settings_.maxWaveSeconds);
        return size;
    }

    /// Returns false if cancelled.
    bool RenderWave(int size) {
        renderer_.UpdateIfDue();
        const Clock::time_point start = Clock::now();
        const int taken = renderer_.Render(size);
        if (taken == 0) return false;
        secondsPerSample_ = SecondsSince(start) / taken;
        if (settings_.afterWave || reference_.IsKept()) renderer_.Gather();
        result_.mse = reference_.Log(renderer_.Done(), context_.film);
        if (!IsDone()) renderer_.DecideIfDue();
        ShowProgress();
        if (settings_.afterWave) {
            Describe();
            settings_.afterWave(result_);
        }
        return true;
    }

    /// Of renders whose end is not a number of samples.
    void ShowProgress() {
        if (settings_.HasKnownEnd()) return;
        const double spent = SecondsSince(settings_.start);
        double left =
            IsTimed() ? settings_.timeBudget - spent : secondsPerSample_ * (settings_.EndSample() - renderer_.Done());
        if (settings_.noise > 0 && renderer_.Noise())
            left = std::min(left, secondsPerSample_ * (SamplesForNoise(renderer_.Position().plan.begin,
                                                                       *renderer_.Noise(), settings_.noise) -
                                                       renderer_.Done()));
        left = std::max(left, 0.0);
        context_.progress.SetFraction(spent / std::max(spent + left, 1e-9), left);
    }

    const RenderContext &context_;
    const RenderSettings &settings_;
    ReferenceLog reference_;
    WaveRenderer renderer_;
    double secondsPerSample_;
    Clock::time_point start_, saved_;
    RenderResult result_;
};

}  // namespace

RenderResult RenderWaves(const RenderContext &context, const RenderSettings &settings) {
    return WaveLoop(context, settings).Run();
}

namespace {

/// Cancels work at a deadline, through its progress.
class Deadline : public ProgressSink {
  public:
    explicit Deadline(double seconds) : end_(Clock::now() + std::chrono::duration<double>(seconds)) {}
    void Show(const std::string &, double fraction, double, double) override {
        fraction_ = fraction;
        if (Clock::now() > end_) progress.Cancel();
    }
    void PhaseDone(const std::string &, double) override {}
    /// Of the phase, at cancellation.
    double Fraction() const { return fraction_; }

    Progress progress{this};

  private:
    const std::chrono::time_point<Clock, std::chrono::duration<double>> end_;
    double fraction_ = 0;
};

}  // namespace

int FittingSamples(double seconds, double secondsPerSample) {
    const double fitting = std::clamp(seconds / std::max(secondsPerSample, 1e-9), 1.0, 1e6);
    return int(std::lround(std::exp2(std::round(4 * std::log2(fitting)) / 4)));
}

double MeasureSecondsPerSample(const RenderContext &context, RenderSettings settings, double seconds) {
    Deadline deadline(seconds / 20);
    settings.timeBudget = 0;                                                  // progress by samples
    settings.samplesPerPixel = std::max(settings.samplesPerPixel, kMaxWave);  // no wave ends at a batch boundary
    WaveRenderer renderer(
        {context.integrator, context.camera, context.filter, context.film, context.sampler, deadline.progress},
        settings);
    const Clock::time_point start = Clock::now();
    const auto since = [](Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); };
    double fastest = std::numeric_limits<double>::infinity();  // the others were disturbed, or warmed up
    for (int wave = 0;; ++wave) {
        const int size = std::min(std::max(1, 1 << std::min(wave, 30) >> 1), kMaxWave);
        deadline.progress.BeginPhase("measuring", size * context.film.PixelBounds().Area());
        const Clock::time_point waveStart = Clock::now();
        const int taken = renderer.Render(size);
        const double spent = since(waveStart);
        deadline.progress.EndPhase();
        if (taken > 0) fastest = std::min(fastest, spent / taken);
        if (taken == 0 && std::isinf(fastest)) return spent / (size * std::max(deadline.Fraction(), 1e-3));
        if (taken == 0 || (wave > 0 && since(start) > seconds / 50)) return fastest;
    }
}

}  // namespace pbrt
