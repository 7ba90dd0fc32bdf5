#include "pbrt/core/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pbrt {
namespace {

std::string Duration(double seconds) {
    if (!(seconds >= 0) || !std::isfinite(seconds)) return "--:--";
    auto s = int64_t(seconds + 0.5);
    if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
    return fmt::format("{:02}:{:02}", s / 60, s % 60);
}

class BarSink final : public ProgressSink {
  public:
    void Show(const std::string &phase, double fraction, double elapsed, double remaining) override {
        constexpr int kCells = 30;
        int full = int(kCells * std::clamp(fraction, 0.0, 1.0));
        std::fprintf(stderr, "\r\033[K%-10s [%s%s] %3d%%  %s elapsed, %s left", phase.c_str(),
                     std::string(full, '#').c_str(), std::string(kCells - full, '.').c_str(), int(100 * fraction),
                     Duration(elapsed).c_str(), Duration(remaining).c_str());
        std::fflush(stderr);
    }
    void PhaseDone(const std::string &phase, double elapsed) override {
        std::fprintf(stderr, "\r\033[K%-10s done in %.2f s\n", phase.c_str(), elapsed);
    }
};

class LineSink final : public ProgressSink {
  public:
    void Show(const std::string &phase, double fraction, double elapsed, double remaining) override {
        if (phase == last_ && elapsed < lastShown_ + 5) return;
        if (elapsed < 2) return;
        last_ = phase;
        lastShown_ = elapsed;
        std::fprintf(stderr, "%s: %d%%, %s elapsed, %s left\n", phase.c_str(), int(100 * fraction),
                     Duration(elapsed).c_str(), Duration(remaining).c_str());
    }
    void PhaseDone(const std::string &phase, double elapsed) override {
        last_.clear();
        std::fprintf(stderr, "%s: done in %.2f s\n", phase.c_str(), elapsed);
    }

  private:
    std::string last_;
    double lastShown_ = 0;
};

}  // namespace

std::unique_ptr<ProgressSink> MakeTerminalProgress(bool quiet) {
    if (quiet) return nullptr;
    if (isatty(STDERR_FILENO)) return std::make_unique<BarSink>();
    return std::make_unique<LineSink>();
}

void Progress::BeginPhase(std::string name, int64_t total) {
    phase_.done = done_;
    if (!phase_.name.empty()) outer_.push_back(std::move(phase_));
    phase_ = {std::move(name), total, 0, Now()};
    done_ = 0;
    nextShowMs_ = 100;
}

void Progress::Advance(int64_t amount) {
    int64_t done = done_.fetch_add(amount, std::memory_order_relaxed) + amount;
    if (sink_ && phase_.total > 0) ShowIfDue(double(done) / double(phase_.total));
}

void Progress::SetFraction(double fraction, double remainingSeconds) {
    if (sink_) ShowIfDue(fraction, remainingSeconds);
}

void Progress::ShowIfDue(double fraction, std::optional<double> remaining) {
    double elapsed = SecondsSince(phase_.begin);
    auto ms = int64_t(elapsed * 1000);
    int64_t next = nextShowMs_.load(std::memory_order_relaxed);
    if (ms < next || !nextShowMs_.compare_exchange_strong(next, ms + 200)) return;
    if (!remaining) remaining = fraction > 0 ? elapsed * (1 - fraction) / fraction : -1;
    std::lock_guard lock(showMutex_);
    sink_->Show(phase_.name, std::min(1.0, fraction), elapsed, *remaining);
}

double Progress::EndPhase() {
    double elapsed = SecondsSince(phase_.begin);
    if (sink_) sink_->PhaseDone(std::string(2 * outer_.size(), ' ') + phase_.name, elapsed);
    last_ = std::move(phase_.name);
    phase_ = {};
    if (!outer_.empty()) {
        phase_ = std::move(outer_.back());
        outer_.pop_back();
    }
    done_ = phase_.done;
    nextShowMs_ = int64_t(SecondsSince(phase_.begin) * 1000) + 100;
    return elapsed;
}

}  // namespace pbrt
