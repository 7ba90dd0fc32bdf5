#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "pbrt/core/progress.h"

namespace pbrt {

/// Handles Ctrl-C (SIGINT), SIGTERM and SIGHUP while the object lives. A separate thread acts on these signals, so that
/// they work while the program waits for a pipe or builds a scene. Only one object may exist per process. SIGHUP stays
/// ignored if it was ignored before (nohup); SIGPIPE is ignored, so that writing to a closed pipe is an ordinary error.
///
/// The program sets before each phase what the first signal does in it. A second signal ends the process at once in
/// every phase, unless it comes within kRepeat of the first (`timeout` sends its signal twice). Ending at once means:
/// temporary files are removed, a message is printed unless quiet, and the process exits with 128 + the number of the
/// first signal; nothing else runs.
class SignalWatch {
  public:
    static constexpr std::chrono::milliseconds kRepeat{300};
    static constexpr double kForever = 1e9;

    /// Until the first call of EndAtOnce or Cancel, a signal ends the process at once with `message`. Signals cancel
    /// `progress`, which must outlive this object.
    SignalWatch(Progress &progress, std::string message);
    ~SignalWatch();
    SignalWatch(const SignalWatch &) = delete;
    SignalWatch &operator=(const SignalWatch &) = delete;

    /// For a phase that has nothing to save: the first signal ends the process at once. If a signal has come before,
    /// this call ends the process.
    void EndAtOnce(std::string message);
    /// The first signal cancels `progress`, prints `notice`, and gives the program `seconds` to end, counted
    /// from the signal or from this call, whichever is later; then the process is ended at once with `message`.
    /// kForever: there is no such deadline.
    void Cancel(std::string notice, std::string message, double seconds);
    /// The exit status that main returns: 128 + the number of the first signal; 0 if none came.
    int Status() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace pbrt
