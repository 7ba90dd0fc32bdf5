#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

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

/// Progress of the whole job: one phase after another (reading, building, preparing lights, rendering, writing), and
/// the wish to stop. A phase begun inside another is a part of it: its time is not added to the others', and its last
/// line is indented. Advance() is called from many threads; phases change on one.
class Progress {
  public:
    explicit Progress(ProgressSink *sink = nullptr) : sink_(sink) {}

    void BeginPhase(std::string name, int64_t total);
    /// For phases whose size is known only after a while.
    void SetTotal(int64_t total) { phase_.total = total; }
    void Advance(int64_t amount = 1);
    /// For phases that end by the clock: fraction and remaining time are known from elsewhere.
    void SetFraction(double fraction, double remainingSeconds);
    /// Returns the seconds the phase took.
    double EndPhase();
    /// What is being done, or was done last.
    const std::string &PhaseName() const { return phase_.name.empty() ? last_ : phase_.name; }

    /// Asks all work to stop at the next safe point (Ctrl-C). Async-signal-safe.
    void Cancel() { cancelled_.store(true, std::memory_order_relaxed); }
    bool Cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

  private:
    using Clock = std::chrono::steady_clock;
    struct Phase {
        std::string name;
        int64_t total = 0, done = 0;  ///< done: when a part of it begins
        Clock::time_point begin{};
    };
    double Elapsed() const { return std::chrono::duration<double>(Clock::now() - phase_.begin).count(); }
    ProgressSink *sink_;
    Phase phase_;
    std::vector<Phase> outer_;  ///< those that phase_ is a part of
    std::string last_;          ///< name of the phase that ended last
    std::atomic<int64_t> done_{0};
    std::atomic<int64_t> nextShowMs_{0};
    std::mutex showMutex_;
    std::atomic<bool> cancelled_{false};
};

}  // namespace pbrt
