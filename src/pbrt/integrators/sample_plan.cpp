#include "pbrt/integrators/render_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pbrt/core/progress.h"

namespace pbrt {

namespace {

using Clock = std::chrono::steady_clock;

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
