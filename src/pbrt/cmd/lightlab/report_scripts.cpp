#include "pbrt/cmd/lightlab/report_scripts.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

extern char **environ;

namespace pbrt {

namespace {

std::string Environment(const char *name, const char *otherwise) {
    const char *value = std::getenv(name);
    return value && *value ? value : otherwise;
}

/// Exit status of `python script folder`; -1 if it could not be started. Its standard output is dropped: that is the
/// command's own table.
int RunScript(const std::string &python, const std::string &script, const std::string &folder) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    const char *arguments[] = {python.c_str(), script.c_str(), folder.c_str(), nullptr};
    pid_t pid = 0;
    const int failed =
        posix_spawnp(&pid, python.c_str(), &actions, nullptr, const_cast<char *const *>(arguments), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed) return -1;
    int status = 0;
    while (waitpid(pid, &status, 0) < 0)
        if (errno != EINTR) return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

std::string RunReportScripts(const std::string &outFolder, bool quiet) {
    const std::string python = Environment("LIGHTLAB_PYTHON", "/usr/bin/python3");
    const std::string folder = Environment("LIGHTLAB_REPORT_SCRIPTS", PBRT_REPORT_SCRIPTS);
    if (!quiet) std::fprintf(stderr, "drawing charts and report\n");
    for (const char *name : {"charts.py", "report.py"}) {
        const std::string script = folder + "/" + name;
        if (!std::filesystem::exists(script))
            return fmt::format("{} is missing: no {}; the results are in {}.", script,
                               name == std::string("charts.py") ? "charts" : "report.html", outFolder);
        const int status = RunScript(python, script, outFolder);
        if (status != 0)
            return fmt::format("{} {} {} failed ({}): charts or report.html are missing; the results are in {}.",
                               python, script, outFolder,
                               status < 0 ? "not started" : fmt::format("exit status {}", status), outFolder);
    }
    return {};
}

}  // namespace pbrt
