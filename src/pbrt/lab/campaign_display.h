#pragma once
#include <algorithm>
#include <chrono>
#include <string>

#include "pbrt/core/progress.h"

namespace pbrt::lab {

/// Progress and time left of a whole campaign. Work is counted in estimated seconds (or any other unit): the rate so
/// far gives the time left.
class CampaignDisplay {
  public:
    explicit CampaignDisplay(ProgressSink *sink) : sink_(sink) {}

    void SetTotal(double work) { total_ = work; }
    /// Work that an earlier session did.
    void Skip(double work) { total_ -= work; }
    void SetPhase(const std::string &phase) { phase_ = phase; }
    void Advance(double work) {
        done_ += work;
        Show();
    }
    /// Begins to measure the rate anew.
    void StartClock() {
        begin_ = Clock::now();
        done_ = 0;
    }
    void Show() {
        const Clock::time_point now = Clock::now();
        if (!sink_ || now - shown_ < std::chrono::milliseconds(200)) return;
        shown_ = now;
        const double elapsed = std::chrono::duration<double>(now - start_).count();
        const double spent = std::chrono::duration<double>(now - begin_).count();
        const double fraction = total_ > 0 ? std::min(1.0, done_ / total_) : 0;
        sink_->Show(phase_, fraction, elapsed, done_ > 0 ? spent * (1 - fraction) / fraction : -1);
    }
    void Finish() {
        if (sink_) sink_->PhaseDone("campaign", std::chrono::duration<double>(Clock::now() - start_).count());
    }

  private:
    using Clock = std::chrono::steady_clock;
    ProgressSink *sink_;
    std::string phase_;
    double total_ = 0, done_ = 0;
    Clock::time_point start_ = Clock::now(), begin_ = start_, shown_ = start_;
};

}  // namespace pbrt::lab
