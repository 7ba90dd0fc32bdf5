#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

namespace pbrt {

/// Where progress is shown. Work only reports phase, done and total; sinks decide how that looks.
class ProgressSink {
  public:
    virtual ~ProgressSink() = default;
    virtual void Show(const std::string &phase, double fraction, double elapsedSeconds, double remainingSeconds) = 0;
    virtual void PhaseDone(const std::string &phase, double elapsedSeconds) = 0;
};

/// A bar on one line that rewrites itself if `fd` is a terminal, else a plain line now and then; nothing when quiet.
std::unique_ptr<ProgressSink> MakeTerminalProgress(bool quiet);

/// Progress of the whole job: one phase after another (reading, building, prepass, octree, rendering), and the wish to
/// stop. Advance() is called from many threads; phases change on one.
class Progress {
  public:
    explicit Progress(ProgressSink *sink = nullptr) : sink_(sink) {}

    void BeginPhase(std::string name, int64_t total);
    void Advance(int64_t amount = 1);
    /// For phases that end by the clock: fraction and remaining time are known from elsewhere.
    void SetFraction(double fraction, double remainingSeconds);
    /// Returns the seconds the phase took.
    double EndPhase();
    /// What is being done, or was done last.
    const std::string &PhaseName() const { return phase_; }

    /// Asks all work to stop at the next safe point (Ctrl-C). Async-signal-safe.
    void Cancel() { cancelled_.store(true, std::memory_order_relaxed); }
    bool Cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

  private:
    using Clock = std::chrono::steady_clock;
    double Elapsed() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }
    ProgressSink *sink_;
    std::string phase_;
    std::atomic<int64_t> done_{0};
    int64_t total_ = 0;
    Clock::time_point begin_{};
    std::atomic<int64_t> nextShowMs_{0};
    std::mutex showMutex_;
    std::atomic<bool> cancelled_{false};
};

}  // namespace pbrt
