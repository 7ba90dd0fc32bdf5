#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace pbrt {

/// Where progress is shown. The work reports only its phase, the amount done and the total; sinks decide how this is
/// displayed.
class ProgressSink {
  public:
    virtual ~ProgressSink() = default;
    virtual void Show(const std::string &phase, double fraction, double elapsedSeconds, double remainingSeconds) = 0;
    virtual void PhaseDone(const std::string &phase, double elapsedSeconds) = 0;
};

/// Writes to standard error: a progress bar that is redrawn in place if it is a terminal, else a plain line every 5
/// seconds at most. Null if `quiet`.
std::unique_ptr<ProgressSink> MakeTerminalProgress(bool quiet);

/// Progress of the whole job: one phase after another (reading, building, preparing lights, rendering, writing), and
/// the request to stop. A phase begun inside another is a part of it: its time is included in the outer phase's, and
/// its last line is indented. Advance() is called from many threads; phases change on one.
class Progress {
  public:
    explicit Progress(ProgressSink *sink = nullptr) : sink_(sink) {}

    void BeginPhase(std::string name, int64_t total);
    /// For phases whose total is known only after they have begun.
    void SetTotal(int64_t total) { phase_.total = total; }
    void Advance(int64_t amount = 1);
    /// For phases that end at a given time: the caller gives the fraction done and the remaining time.
    void SetFraction(double fraction, double remainingSeconds);
    /// Returns the seconds the phase took.
    double EndPhase();
    /// Name of the running phase, or of the one that ended last if none is running.
    const std::string &PhaseName() const { return phase_.name.empty() ? last_ : phase_.name; }

    /// Asks all work to stop at the next safe point (Ctrl-C). Async-signal-safe.
    void Cancel() { cancelled_.store(true, std::memory_order_relaxed); }
    bool Cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

  private:
    using Clock = std::chrono::steady_clock;
    struct Phase {
        std::string name;
        int64_t total = 0, done = 0;  ///< done: as it was when an inner phase began
        Clock::time_point begin{};
    };
    double Elapsed() const { return std::chrono::duration<double>(Clock::now() - phase_.begin).count(); }
    ProgressSink *sink_;
    Phase phase_;
    std::vector<Phase> outer_;  ///< the phases that phase_ is a part of, outermost first
    std::string last_;          ///< name of the phase that ended last
    std::atomic<int64_t> done_{0};
    std::atomic<int64_t> nextShowMs_{0};
    std::mutex showMutex_;
    std::atomic<bool> cancelled_{false};
};

}  // namespace pbrt
