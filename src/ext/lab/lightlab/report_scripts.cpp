#include "ext/lab/lightlab/lightlab.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace ext::lab {
namespace {

std::string Environment(const char *name, const char *otherwise) {
    const char *value = std::getenv(name);
    return value && *value ? value : otherwise;
}

/// Script folder, relative to the program so that installations are relocatable: beside it, or in share/ if installed.
std::string ScriptFolder() {
    std::error_code failed;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failed).parent_path();
    const std::filesystem::path beside = program / "report";
    if (std::filesystem::exists(beside, failed)) return beside.string();
    return (program / "../share/pbrt_octree/report").lexically_normal().string();
}

/// Replaces the forked child by the program. Makes only calls that are async-signal-safe, as required after a fork in a
/// multithreaded process.
[[noreturn]] void Become(const char *const *arguments, pid_t parent, const sigset_t &mask, int failures) {
    // The handlers of these signals belong to the parent; in the child they terminate, or stay ignored.
    for (int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction action = {};
        if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN) continue;
        action = {};
        action.sa_handler = SIG_DFL;
        sigaction(signal, &action, nullptr);
    }
    pthread_sigmask(SIG_SETMASK, &mask, nullptr);
    // Terminates with the parent, however that ends.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() == parent) {
        if (const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC); nowhere >= 0) dup2(nowhere, STDOUT_FILENO);
        execvp(arguments[0], const_cast<char *const *>(arguments));
    }
    const int reason = errno;
    [[maybe_unused]] const ssize_t ignored = write(failures, &reason, sizeof(reason));
    _exit(127);
}

/// Runs `python script folder`. Returns why it failed, empty on success. Discards its standard output, as lightlab's
/// own holds the table. Call from a thread that lives as long as the process.
std::string RunScript(const std::string &python, const std::string &script, const std::string &folder) {
    const char *arguments[] = {python.c_str(), script.c_str(), folder.c_str(), nullptr};
    auto notStarted = [](int reason) { return fmt::format("not started: {}", std::strerror(reason)); };
    int failures[2];  // pipe for the errno of a failed start; closed by a successful one
    if (pipe2(failures, O_CLOEXEC) != 0) return notStarted(errno);
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const pid_t parent = getpid(), pid = fork();
    if (pid == 0) Become(arguments, parent, before, failures[1]);
    int reason = errno;
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    close(failures[1]);
    const bool started = pid > 0 && read(failures[0], &reason, sizeof(reason)) <= 0;
    close(failures[0]);
    int status = 0;
    while (pid > 0 && waitpid(pid, &status, 0) < 0)
        if (errno != EINTR) return notStarted(errno);
    if (!started) return notStarted(reason);
    if (WIFSIGNALED(status)) return fmt::format("ended by signal {}", WTERMSIG(status));
    return WEXITSTATUS(status) ? fmt::format("exit status {}", WEXITSTATUS(status)) : "";
}

}  // namespace

std::string RunReportScripts(const std::string &outFolder, bool quiet) {
    const std::string python = Environment("LIGHTLAB_PYTHON", "/usr/bin/python3");
    const std::string folder = Environment("LIGHTLAB_REPORT_SCRIPTS", ScriptFolder().c_str());
    if (!quiet) std::fprintf(stderr, "drawing charts and report\n");
    for (const auto &[name, output] : {std::pair{"charts.py", "charts"}, {"report.py", "report.html"}}) {
        const std::string script = folder + "/" + name;
        if (!std::filesystem::exists(script))
            return fmt::format("{} is missing: no {}; the results are in {}.", script, output, outFolder);
        if (const std::string failure = RunScript(python, script, outFolder); !failure.empty())
            return fmt::format("{} {} {} failed ({}): charts or report.html are missing; the results are in {}.",
                               python, script, outFolder, failure, outFolder);
    }
    return {};
}

}  // namespace ext::lab
