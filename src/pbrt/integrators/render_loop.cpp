#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>

#include "pbrt/images/metrics.h"
#include "pbrt/integrators/wave_renderer.h"

namespace pbrt {
namespace {

using Clock = Progress::Clock;

/// Logs one line "samples, mean squared error" per wave against a reference image.
class ReferenceLog {
  public:
    /// Reads the reference and creates the file of errors, or appends to it in a resumed render; without names a log
    /// that does nothing. Throws UserError if the reference does not cover the film or a file cannot be opened.
    static ReferenceLog Open(const RenderSettings &settings, const Film &film) {
        ReferenceLog log;
        const std::string &path = settings.mseReferenceImage;
        if (path.empty()) return log;
        log.reference_ = film.PixelsIn(ReadImage(path), path);
        log.name_ = settings.mseReferenceOut;
        log.out_.open(log.name_, settings.from ? std::ios::app : std::ios::out);
        if (!log.out_) throw UserError("{}: cannot be written: {}.", log.name_, std::strerror(errno));
        return log;
    }

    /// Writes and returns the mean squared error of the film over R, G and B; empty without a reference.
    std::optional<double> Log(int samples, const Film &film) {
        if (!reference_) return {};
        Image image = film.ToImage();
        if (image.ChannelCount() > 3) image = image.Select({"R", "G", "B"});
        double mse = ImageError(image, reference_, Metric::MSE);
        // If the log cannot be written, the render continues without it.
        if (out_.is_open() && !(out_ << fmt::format("{}, {:.9g}\n", samples, mse) << std::flush)) {
            Fail();
            out_.close();
        }
        return mse;
    }

    /// Closes the file. Returns why it is incomplete; empty if complete.
    const std::string &Finish() {
        // Some file systems report failed writes only on close.
        if (out_.is_open()) out_.close();
        if (failure_.empty() && !out_) Fail();
        return failure_;
    }

  private:
    ReferenceLog() = default;
    void Fail() { failure_ = fmt::format("{}: cannot be written: {}.", name_, std::strerror(errno)); }

    Image reference_;
    std::string name_, failure_;
    std::ofstream out_;
};

class WaveLoop {
  public:
    WaveLoop(const RenderContext &context, const RenderSettings &settings)
        : context_(context), settings_(settings), reference_(ReferenceLog::Open(settings, context.film)),
          renderer_(context, settings), secondsPerSample_(settings.secondsPerSample) {}

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
        result_.seconds = settings_.secondsBefore + progress.SecondsSince(start_);
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
        result_.samplesTaken = renderer_.Done() - settings_.firstSample;
        result_.seconds = settings_.secondsBefore + context_.progress.SecondsSince(start_);
        if (context_.half)
            result_.adaptive =
                DescribeAdaptive(context_.film, *context_.half, renderer_.Position().plan, renderer_.Done());
    }

    void Begin() {
        Progress &progress = context_.progress;
        const int64_t pixels = context_.film.PixelBounds().Area();
        progress.BeginPhase("rendering", settings_.HasKnownEnd() ? pixels * settings_.SampleCount() : 0);
        start_ = progress.Now();
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
        if (!settings_.checkpoint || context_.progress.SecondsSince(saved_) < settings_.checkpointInterval) return;
        renderer_.Gather();
        Describe();
        result_.cancelled = true;  // until the last checkpoint, which a killed render never writes
        settings_.checkpoint(renderer_.Position(), result_);
        result_.cancelled = false;
        saved_ = context_.progress.Now();
    }

    /// Samples per pixel of the next wave, at most `wave`; 0 if less than half a sample fits the time budget.
    int SizeOf(int wave) const {
        int size = IsTimed() ? wave : std::min(wave, settings_.EndSample() - renderer_.Done());
        if (!(secondsPerSample_ > 0)) return size;
        if (IsTimed()) {
            const double left = settings_.timeBudget - context_.progress.SecondsSince(settings_.start);
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
        const Clock::time_point start = context_.progress.Now();
        const int taken = renderer_.Render(size);
        if (taken == 0) return false;
        secondsPerSample_ = context_.progress.SecondsSince(start) / taken;
        if (settings_.afterWave || !settings_.mseReferenceImage.empty()) renderer_.Gather();
        result_.mse = reference_.Log(renderer_.Done() - settings_.firstSample, context_.film);
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
        const double spent = context_.progress.SecondsSince(settings_.start);
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

/// Cancels work at a deadline, through its progress.
class Deadline : public ProgressSink {
  public:
    /// By the clock of `time`.
    Deadline(const Progress &time, double seconds)
        : progress(this, [&time] { return time.Now(); }), end_(time.Now() + std::chrono::duration<double>(seconds)) {}
    void Show(const std::string &, double fraction, double, double) override {
        fraction_ = fraction;
        if (progress.Now() > end_) progress.Cancel();
    }
    void PhaseDone(const std::string &, double) override {}
    /// Of the phase, at cancellation.
    double Fraction() const { return fraction_; }

    Progress progress;

  private:
    const std::chrono::time_point<Clock, std::chrono::duration<double>> end_;
    double fraction_ = 0;
};

}  // namespace

void FollowWaves(const RenderContext &context, const RenderSettings &settings) {
    context.progress.BeginPhase("rendering", 0);
    WaveRenderer(context, settings).Follow();
    context.progress.EndPhase();
}

RenderResult RenderWaves(const RenderContext &context, const RenderSettings &settings) {
    return WaveLoop(context, settings).Run();
}

int FittingSamples(double seconds, double secondsPerSample) {
    const double fitting = std::clamp(seconds / std::max(secondsPerSample, 1e-9), 1.0, 1e6);
    return int(std::lround(std::exp2(std::round(4 * std::log2(fitting)) / 4)));
}

double MeasureSecondsPerSample(const RenderContext &context, RenderSettings settings, double seconds) {
    Deadline deadline(context.progress, seconds / 20);
    settings.timeBudget = 0;                                                  // progress by samples
    settings.samplesPerPixel = std::max(settings.samplesPerPixel, kMaxWave);  // no wave ends at a batch boundary
    WaveRenderer renderer(
        {context.integrator, context.camera, context.filter, context.film, context.sampler, deadline.progress},
        settings);
    const Clock::time_point start = context.progress.Now();
    double fastest = std::numeric_limits<double>::infinity();  // the others were disturbed, or warmed up
    for (int wave = 0;; ++wave) {
        const int size = std::min(std::max(1, 1 << std::min(wave, 30) >> 1), kMaxWave);
        deadline.progress.BeginPhase("measuring", size * context.film.PixelBounds().Area());
        const Clock::time_point waveStart = context.progress.Now();
        const int taken = renderer.Render(size);
        const double spent = context.progress.SecondsSince(waveStart);
        deadline.progress.EndPhase();
        if (taken > 0) fastest = std::min(fastest, spent / taken);
        if (taken == 0 && std::isinf(fastest)) return spent / (size * std::max(deadline.Fraction(), 1e-3));
        if (taken == 0 || (wave > 0 && context.progress.SecondsSince(start) > seconds / 50)) return fastest;
    }
}

}  // namespace pbrt
