#pragma once
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pbrt {

inline double SecondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Seconds of a clock of the system, such as the CPU time of this thread; 0 if there is none.
inline double ClockSeconds(clockid_t clock) {
    timespec t = {};
    clock_gettime(clock, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

/// Display of progress. Reports contain only phase, amount done and total.
class ProgressSink {
  public:
    virtual ~ProgressSink() = default;
    virtual void Show(const std::string &phase, double fraction, double elapsedSeconds, double remainingSeconds) = 0;
    virtual void PhaseDone(const std::string &phase, double elapsedSeconds) = 0;
};

/// Writes to standard error: a redrawn bar on a terminal, else a line at most every 5 seconds. Null if `quiet`.
std::unique_ptr<ProgressSink> MakeTerminalProgress(bool quiet);

/// Progress of the whole job as a sequence of phases (reading, building, preparing lights, rendering, writing), and the
/// stop request. Nested phases are included in the outer phase's time and printed indented. Advance() is thread-safe;
/// phases change on one thread.
class Progress {
  public:
    using Clock = std::chrono::steady_clock;
    /// `now`: the clock of these phases, and of everything that reads the time here.
    explicit Progress(ProgressSink *sink = nullptr, std::function<Clock::time_point()> now = &Clock::now)
        : sink_(sink), now_(std::move(now)) {}

    void BeginPhase(std::string name, int64_t total) {
        phase_.done = done_;
        if (!phase_.name.empty()) outer_.push_back(std::move(phase_));
        phase_ = {std::move(name), total, 0, Now()};
        done_ = 0;
        nextShowMs_ = 100;
    }
    /// For phases whose total becomes available later.
    void SetTotal(int64_t total) { phase_.total = total; }
    void Advance(int64_t amount = 1) {
        int64_t done = done_.fetch_add(amount, std::memory_order_relaxed) + amount;
        if (sink_ && phase_.total > 0) ShowIfDue(double(done) / double(phase_.total));
    }
    /// For phases with a time budget: fraction done and remaining time.
    void SetFraction(double fraction, double remainingSeconds) {
        if (sink_) ShowIfDue(fraction, remainingSeconds);
    }
    /// Returns the phase's duration in seconds.
    double EndPhase() {
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
    Clock::time_point Now() const { return now_(); }
    double SecondsSince(Clock::time_point start) const { return std::chrono::duration<double>(Now() - start).count(); }
    const std::string &PhaseName() const { return phase_.name.empty() ? last_ : phase_.name; }

    /// Requests a stop at the next safe point (Ctrl-C). Async-signal-safe.
    void Cancel() { cancelled_.store(true, std::memory_order_relaxed); }
    bool Cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

  private:
    struct Phase {
        std::string name;
        int64_t total = 0, done = 0;  ///< done: value when an inner phase began
        Clock::time_point begin{};
    };
    /// Shows the phase unless it was shown just before. `remaining`: seconds; empty: estimated from the fraction.
    void ShowIfDue(double fraction, std::optional<double> remaining = {}) {
        double elapsed = SecondsSince(phase_.begin);
        auto ms = int64_t(elapsed * 1000);
        int64_t next = nextShowMs_.load(std::memory_order_relaxed);
        if (ms < next || !nextShowMs_.compare_exchange_strong(next, ms + 200)) return;
        if (!remaining) remaining = fraction > 0 ? elapsed * (1 - fraction) / fraction : -1;
        std::lock_guard lock(showMutex_);
        sink_->Show(phase_.name, std::min(1.0, fraction), elapsed, *remaining);
    }
    ProgressSink *sink_;
    const std::function<Clock::time_point()> now_;
    Phase phase_;
    std::vector<Phase> outer_;  ///< phases that enclose phase_, outermost first
    std::string last_;          ///< last ended phase
    std::atomic<int64_t> done_{0};
    std::atomic<int64_t> nextShowMs_{0};
    std::mutex showMutex_;
    std::atomic<bool> cancelled_{false};
};

}  // namespace pbrt
