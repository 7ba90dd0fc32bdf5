#pragma once
#include <chrono>
#include <memory>
#include <string>

#include "pbrt/core/progress.h"

namespace pbrt {

/// Handles SIGINT, SIGTERM and SIGHUP during its lifetime, in a separate thread, so that signals work while the program
/// waits for a pipe or builds a scene. Only one object may exist per process. SIGHUP stays ignored if it was ignored
/// already (nohup). SIGPIPE is ignored: writing to a closed pipe is an ordinary error.
///
/// The response to the first signal is set per phase. A second signal ends the process at once, unless it comes within
/// kRepeat of the first (`timeout` sends its signal twice). Ending at once removes temporary files, prints a message
/// unless quiet, and exits with 128 + the first signal; nothing else runs. Times are those of the progress' clock.
class SignalWatch {
  public:
    static constexpr std::chrono::milliseconds kRepeat{300};
    static constexpr double kForever = 1e9;

    /// Until the first call of EndAtOnce or Cancel, a signal ends the process at once with `message`. `progress` must
    /// outlive this object.
    SignalWatch(Progress &progress, std::string message);
    ~SignalWatch();
    SignalWatch(const SignalWatch &) = delete;
    SignalWatch &operator=(const SignalWatch &) = delete;

    /// For a phase without results to save: a signal ends the process at once, an earlier one in this call.
    void EndAtOnce(std::string message) { Cancel("", std::move(message), 0); }
    /// The first signal cancels `progress` and prints `notice`. The process is ended with `message` `seconds` after the
    /// signal or this call, whichever is later. kForever: no deadline.
    void Cancel(std::string notice, std::string message, double seconds);
    /// Exit status for main: 128 + the first signal; 0 if none came.
    int Status() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace pbrt
