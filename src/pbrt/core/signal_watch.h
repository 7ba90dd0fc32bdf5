#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "pbrt/core/progress.h"

namespace pbrt {

/// What Ctrl-C (SIGINT), SIGTERM and SIGHUP do while the object lives. A thread of its own acts on them, so that they
/// work while the program waits for a pipe or builds. One per process. SIGHUP stays ignored if it was (nohup); SIGPIPE
/// is ignored: writing to a closed pipe is an error like others.
///
/// The program says before each phase what the first signal does there. A second one ends the process at once in every
/// phase, unless it comes within kRepeat (`timeout` sends its signal twice). To end at once is to remove temporary
/// files, to print a message unless quiet, and to exit with 128 + the signal's number; nothing else runs.
class SignalWatch {
  public:
    static constexpr std::chrono::milliseconds kRepeat{300};
    static constexpr double kForever = 1e9;

    /// At first signals end the process at once, with `message`. `progress` is cancelled by signals and must outlive
    /// this.
    SignalWatch(Progress &progress, std::string message);
    ~SignalWatch();
    SignalWatch(const SignalWatch &) = delete;
    SignalWatch &operator=(const SignalWatch &) = delete;

    /// The phase has nothing to save: the first signal ends the process at once. If one came before, now.
    void EndAtOnce(std::string message);
    /// The first signal cancels `progress`, prints `notice`, and leaves the program `seconds` to end by itself, from
    /// the signal or this call on, whichever is later; after that it ends at once, with `message`.
    void Cancel(std::string notice, std::string message, double seconds);
    /// 128 + number of the first signal; 0 if none came. To be returned by main.
    int Status() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace pbrt
