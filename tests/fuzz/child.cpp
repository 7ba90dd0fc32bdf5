#include "fuzz/child.h"

#include <execinfo.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <stdexcept>

namespace pbrt::fuzz {

namespace {

#ifdef __SANITIZE_ADDRESS__
constexpr bool kAddressSanitizer = true;
#else
constexpr bool kAddressSanitizer = false;
#endif

constexpr int kMaxFrames = 64;
constexpr size_t kKeptMessages = 1 << 16;
const int kWhereSignal = SIGRTMIN + 3;  // makes the child record its stack and end
constexpr double kWallPerCpu = 8;       // wall-clock time allowed per CPU time; the machine may be busy

double Seconds(clockid_t clock) {
    timespec t{};
    return clock_gettime(clock, &t) == 0 ? double(t.tv_sec) + 1e-9 * double(t.tv_nsec) : -1;
}

size_t AddressSpaceInUse() {
    size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * size_t(sysconf(_SC_PAGESIZE));
}

void Limit(decltype(RLIMIT_AS) which, size_t value) {
    const rlimit limit{value, value};
    setrlimit(which, &limit);
}

}  // namespace

struct SharedWithChild {
    int signal = 0, frameCount = 0;
    std::array<void *, kMaxFrames> frames{};
    PictureReport picture;
};

namespace {

SharedWithChild *sharedMemory = nullptr;  ///< of this process, for the signal handler

void RecordAndDie(int signal) {
    sharedMemory->signal = signal;
    sharedMemory->frameCount = backtrace(sharedMemory->frames.data(), kMaxFrames);
    if (signal == kWhereSignal) _exit(1);
    std::signal(signal, SIG_DFL);
    raise(signal);
}

/// An exception that is not caught must end the child, not continue in a copy of the parent.
int RunToTheEnd(const ChildBody &body, PictureReport &report) noexcept { return body(report); }

void HandleSignals() {
    // A stack of its own: the usual cause of a fault is a stack that overflowed.
    static std::array<char, 1 << 16> stack;
    stack_t alternative{};
    alternative.ss_sp = stack.data();
    alternative.ss_size = stack.size();
    sigaltstack(&alternative, nullptr);
    struct sigaction action {};
    action.sa_handler = RecordAndDie;
    action.sa_flags = SA_ONSTACK | SA_NODEFER;
    for (int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS, kWhereSignal}) {
        // AddressSanitizer reports more about faults than a handler can.
        if (kAddressSanitizer && (signal == SIGSEGV || signal == SIGBUS)) continue;
        sigaction(signal, &action, nullptr);
    }
}

}  // namespace

Child::Child() {
    void *memory = mmap(nullptr, sizeof(SharedWithChild), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::runtime_error("no shared memory");
    shared_ = new (memory) SharedWithChild;
    messagesFd_ = int(memfd_create("messages", MFD_CLOEXEC));
    if (messagesFd_ < 0) throw std::runtime_error("no file in memory for messages");
    // The first call loads a library, which a handler must not.
    std::array<void *, 2> frames{};
    backtrace(frames.data(), 2);
}

Child::~Child() {
    if (pid_ > 0) {
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
        close(endFd_);
    }
    close(messagesFd_);
    munmap(shared_, sizeof(SharedWithChild));
}

void Child::Start(const std::string &folder, const ChildBody &body, const Limits &limits) {
    *shared_ = SharedWithChild();
    result_ = ChildResult();
    limits_ = limits;
    stage_ = Stage::Running;
    if (ftruncate(messagesFd_, 0) != 0 || lseek(messagesFd_, 0, SEEK_SET) != 0) throw std::runtime_error("messages");
    std::fflush(nullptr);
    const size_t addressSpace = AddressSpaceInUse() + (limits.memoryMb << 20);
    pid_ = fork();
    if (pid_ < 0) throw std::runtime_error("fork failed");
    if (pid_ == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        dup2(messagesFd_, STDOUT_FILENO);
        dup2(messagesFd_, STDERR_FILENO);
        const int nothing = open("/dev/null", O_RDONLY);
        dup2(nothing, STDIN_FILENO);
        Limit(RLIMIT_CORE, 0);
        Limit(RLIMIT_FSIZE, limits.fileMb << 20);
        if (!kAddressSanitizer) Limit(RLIMIT_AS, addressSpace);
        // Writing beyond the limit is an error that the program should report.
        std::signal(SIGXFSZ, SIG_IGN);
        sharedMemory = shared_;
        HandleSignals();
        if (chdir(folder.c_str()) != 0) _exit(126);
        const int status = RunToTheEnd(body, shared_->picture);
        std::fflush(nullptr);
        // Without the functions registered for exit: OpenImageIO's libraries would wait there for threads that were not
        // forked.
        _exit(status);
    }
    endFd_ = int(syscall(SYS_pidfd_open, pid_, 0));
    if (endFd_ < 0) throw std::runtime_error("pidfd_open failed");
    if (clock_getcpuclockid(pid_, &clock_) != 0) clock_ = CLOCK_MONOTONIC;
    startWall_ = Seconds(CLOCK_MONOTONIC);
}

void Child::EnforceTime() {
    const double wall = Seconds(CLOCK_MONOTONIC), cpu = Seconds(clock_);
    switch (stage_) {
        case Stage::Running:
            if (cpu < limits_.seconds && wall - startWall_ < kWallPerCpu * limits_.seconds) return;
            result_.wasTerminated = true;
            stopWall_ = wall;
            stopCpu_ = cpu;
            stage_ = Stage::Terminating;
            kill(pid_, SIGTERM);
            return;
        case Stage::Terminating:
            if (cpu - stopCpu_ < limits_.graceSeconds && wall - stopWall_ < kWallPerCpu * limits_.graceSeconds) return;
            result_.hung = true;
            killWall_ = wall;
            stage_ = Stage::Tracing;
            kill(pid_, kWhereSignal);
            return;
        case Stage::Tracing:
            if (wall - killWall_ > 1) kill(pid_, SIGKILL);
            return;
    }
}

bool Child::Poll(int milliseconds) {
    pollfd end{endFd_, POLLIN, 0};
    poll(&end, 1, milliseconds);
    siginfo_t info{};
    rusage usage{};
    if (waitid(P_PID, id_t(pid_), &info, WEXITED | WNOHANG | WNOWAIT) != 0) throw std::runtime_error("wait");
    if (info.si_pid == 0) {
        EnforceTime();
        return false;
    }
    int status = 0;
    wait4(pid_, &status, 0, &usage);
    close(endFd_);
    endFd_ = pid_ = -1;
    if (WIFEXITED(status)) result_.status = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) result_.signal = WTERMSIG(status);
    // After a signal a sanitizer ends the process with its own exit status.
    if (shared_->signal != 0 && shared_->signal != kWhereSignal) result_.signal = shared_->signal;
    auto seconds = [](const timeval &t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    result_.seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    result_.frames.assign(shared_->frames.begin(),
                          shared_->frames.begin() + std::clamp(shared_->frameCount, 0, kMaxFrames));
    result_.picture = shared_->picture;
    result_.messageBytes = size_t(std::max<off_t>(0, lseek(messagesFd_, 0, SEEK_END)));
    result_.messages.resize(std::min(result_.messageBytes, kKeptMessages));
    const ssize_t got = pread(messagesFd_, result_.messages.data(), result_.messages.size(), 0);
    result_.messages.resize(size_t(std::max<ssize_t>(0, got)));
    return true;
}

ChildResult Child::Take() { return std::move(result_); }

ChildResult RunChild(const std::string &folder, const ChildBody &body, const Limits &limits) {
    Child child;
    child.Start(folder, body, limits);
    while (!child.Poll(20)) continue;
    return child.Take();
}

}  // namespace pbrt::fuzz
