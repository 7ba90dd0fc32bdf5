#pragma once
#include <sys/types.h>

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace pbrt::fuzz {

struct Limits {
    double seconds = 4;         ///< CPU time until the child gets SIGTERM; eight times as much wall-clock time
    double graceSeconds = 1.5;  ///< CPU time that it then has to stop; eight times as much wall-clock time
    size_t memoryMb = 2048;     ///< address space beyond the parent's (resident memory under AddressSanitizer)
    size_t fileMb = 64;         ///< largest size of any file written, messages included
};

/// What the child found when it read its own picture.
struct PictureReport {
    enum class State { Missing, Good, Bad };
    State state = State::Missing;
    std::array<char, 200> text{};  ///< what is bad
};

/// How a child ended.
struct ChildResult {
    int status = -1;             ///< exit status; -1 if a signal ended it
    int signal = 0;              ///< the signal that ended it, or that its handler saw
    bool wasTerminated = false;  ///< by SIGTERM, at the end of its time
    bool hung = false;           ///< it had to be killed
    std::vector<void *> frames;  ///< the stack at the signal or where it hung, innermost first
    std::string messages;        ///< standard output and error, the first 64 KB
    size_t messageBytes = 0;
    double seconds = 0;  ///< CPU time
    PictureReport picture;
};

/// What a child does: returns the exit status and fills the report.
using ChildBody = std::function<int(PictureReport &)>;

struct SharedWithChild;

/// A child process that runs one case under limits: forked from this process, so what this process has loaded and set
/// up need not be set up again. This process must not have threads.
class Child {
  public:
    Child();
    ~Child();
    Child(const Child &) = delete;
    Child &operator=(const Child &) = delete;

    /// Runs `body` in a new process with `folder` as its working folder.
    void Start(const std::string &folder, const ChildBody &body, const Limits &limits);
    bool Running() const { return pid_ > 0; }
    /// Can be polled for the end of the child.
    int EndDescriptor() const { return endFd_; }
    /// Waits for the end, at most so long; sends the child a stop request, or forces it, when its time is over. True
    /// when the child has ended: then Take returns the result.
    bool Poll(int milliseconds = 0);
    ChildResult Take();

  private:
    void EnforceTime();
    SharedWithChild *shared_;
    pid_t pid_ = -1;
    int endFd_ = -1, messagesFd_ = -1;
    clockid_t clock_{};
    double startWall_ = 0, stopWall_ = 0, stopCpu_ = 0, killWall_ = 0;
    enum class Stage { Running, Terminating, Tracing } stage_ = Stage::Running;
    Limits limits_;
    ChildResult result_;
};

/// Runs a child to its end.
ChildResult RunChild(const std::string &folder, const ChildBody &body, const Limits &limits);

}  // namespace pbrt::fuzz
