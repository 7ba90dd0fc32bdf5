#pragma once
#include <algorithm>
#include <chrono>
#include <string>

#include "ext/lab/experiment_settings.h"
#include "ext/lab/run_record.h"

namespace ext::lab {
using namespace pbrt;

/// Shows progress and remaining time of an experiment, from its phases' estimates.
class ExperimentDisplay {
  public:
    explicit ExperimentDisplay(ProgressSink *sink) : sink_(sink) {}

    void SetPhase(const std::string &phase) { phase_ = phase; }
    /// Sets the estimated seconds of all later phases.
    void SetAfter(double seconds) { after_ = seconds; }
    /// `left`: estimated seconds of the current phase; negative: unknown.
    void Show(double left) {
        const Clock::time_point now = Clock::now();
        if (!sink_ || now - shown_ < std::chrono::milliseconds(200)) return;
        shown_ = now;
        const double elapsed = std::chrono::duration<double>(now - start_).count();
        const bool isKnown = left >= 0;
        const double all = isKnown ? left + after_ : -1;
        sink_->Show(phase_, isKnown ? elapsed / std::max(elapsed + all, 1e-9) : 0, elapsed, all);
    }
    void Finish() {
        if (sink_) sink_->PhaseDone("experiment", std::chrono::duration<double>(Clock::now() - start_).count());
    }

  private:
    using Clock = std::chrono::steady_clock;
    ProgressSink *sink_;
    std::string phase_;
    double after_ = 0;
    Clock::time_point start_ = Clock::now(), shown_ = start_;
};

/// What all parts of an experiment use.
struct ExperimentContext {
    const ExperimentSettings &settings;
    const LabScene &scene;
    const PluginRegistry &registry;
    const RecordFolder &records;
    Progress &cancel;
    ExperimentDisplay &display;
};

}  // namespace ext::lab
