#include "pbrt/core/signal_watch.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>

#include "pbrt/core/files.h"
#include "pbrt/core/log.h"

namespace pbrt {
namespace {

using Clock = Progress::Clock;

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

/// Write end of the pipe from signal handler to watcher thread.
int toWatcher = -1;

void Notify(int signal) {
    const int kept = errno;
    const auto byte = static_cast<unsigned char>(signal);
    [[maybe_unused]] const ssize_t ignored = write(toWatcher, &byte, 1);
    errno = kept;
}

/// Prints a message unless that would block: nothing may delay the end of the process.
void Print(const std::string &message) {
    if (message.empty() || CurrentLogLevel() < LogLevel::Info) return;
    pollfd err{STDERR_FILENO, POLLOUT, 0};
    if (poll(&err, 1, 0) != 1 || !(err.revents & POLLOUT)) return;
    const std::string line = (isatty(STDERR_FILENO) ? "\r\033[K" : "") + message + "\n";
    [[maybe_unused]] const ssize_t ignored = write(STDERR_FILENO, line.data(), line.size());
}

}  // namespace

struct SignalWatch::Impl {
    Progress &progress;
    mutable std::mutex mutex;  ///< protects the members from here to the pipe
    std::string notice, message;
    double grace = 0;  ///< seconds
    Clock::time_point phaseStart = progress.Now();
    int first = 0;  ///< signal; 0: none yet
    Clock::time_point firstTime{};

    int pipe[2] = {-1, -1};
    struct sigaction old[std::size(kSignals)] = {}, oldPipe = {};
    std::thread thread;

    explicit Impl(Progress &p) : progress(p) {}

    std::optional<Clock::time_point> Deadline() const {
        if (!first || grace >= kForever) return {};
        return std::max(phaseStart, firstTime) +
               std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(grace));
    }

    [[noreturn]] void End() const {
        RemoveTemporaries();
        Print(message);
        _exit(128 + first);
    }

    void Take(int signal) {
        std::lock_guard lock(mutex);
        const Clock::time_point now = progress.Now();
        if (!first) {
            first = signal;
            firstTime = now;
            progress.Cancel();
            if (grace <= 0) End();
            Print(notice);
        } else if (now >= firstTime + kRepeat) {
            End();
        }
    }

    /// Milliseconds until the deadline, for poll; ends the process if it has passed.
    int Wait() {
        std::lock_guard lock(mutex);
        const std::optional<Clock::time_point> deadline = Deadline();
        if (!deadline) return -1;
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(*deadline - progress.Now()).count();
        if (left <= 0) End();
        return int(left);
    }

    void Watch() {
        for (;;) {
            pollfd in{pipe[0], POLLIN, 0};
            if (poll(&in, 1, Wait()) < 1) continue;
            unsigned char byte = 0;
            if (read(pipe[0], &byte, 1) != 1) continue;
            if (byte == 0) return;
            if (byte != kWake) Take(byte);
        }
    }

    /// Not a signal number: wakes the thread because the deadline may have changed.
    static constexpr unsigned char kWake = 255;
};

SignalWatch::SignalWatch(Progress &progress, std::string message) : impl_(std::make_unique<Impl>(progress)) {
    impl_->message = std::move(message);
    if (pipe2(impl_->pipe, O_CLOEXEC | O_NONBLOCK) != 0)
        throw std::system_error(errno, std::generic_category(), "the pipe for signals");
    toWatcher = impl_->pipe[1];
    impl_->thread = std::thread([this] { impl_->Watch(); });
    struct sigaction action = {};
    action.sa_handler = Notify;
    action.sa_flags = SA_RESTART;
    for (size_t i = 0; i < std::size(kSignals); ++i) {
        sigaction(kSignals[i], nullptr, &impl_->old[i]);
        if (kSignals[i] == SIGHUP && impl_->old[i].sa_handler == SIG_IGN) continue;
        sigaction(kSignals[i], &action, nullptr);
    }
    struct sigaction ignore = {};
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &ignore, &impl_->oldPipe);
}

SignalWatch::~SignalWatch() {
    for (size_t i = 0; i < std::size(kSignals); ++i) sigaction(kSignals[i], &impl_->old[i], nullptr);
    sigaction(SIGPIPE, &impl_->oldPipe, nullptr);
    const unsigned char stop = 0;
    while (write(impl_->pipe[1], &stop, 1) != 1) {
    }
    impl_->thread.join();
    close(impl_->pipe[0]);
    close(impl_->pipe[1]);
}

void SignalWatch::Cancel(std::string notice, std::string message, double seconds) {
    std::lock_guard lock(impl_->mutex);
    impl_->notice = std::move(notice);
    impl_->message = std::move(message);
    impl_->grace = seconds;
    impl_->phaseStart = impl_->progress.Now();
    Notify(Impl::kWake);
}

int SignalWatch::Status() const {
    std::lock_guard lock(impl_->mutex);
    return impl_->first ? 128 + impl_->first : 0;
}

}  // namespace pbrt
