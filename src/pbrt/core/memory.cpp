#include "pbrt/core/memory.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>

namespace pbrt {
namespace {

/// Beginning of a kernel file; empty if it does not exist. Does not allocate, since memory may be exhausted.
struct KernelText {
    char text[512] = {};
    explicit KernelText(const char *name) {
        const int file = open(name, O_RDONLY | O_CLOEXEC);
        if (file < 0) return;
        const ssize_t got = read(file, text, sizeof(text) - 1);
        text[std::max<ssize_t>(got, 0)] = 0;
        close(file);
    }
};

/// This process's limit in bytes; infinite if there is none.
double LimitOf(decltype(RLIMIT_AS) resource) {
    rlimit limit{};
    const bool isSet = getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
    return isSet ? double(limit.rlim_cur) : std::numeric_limits<double>::infinity();
}

bool isLimited = false;  ///< by LimitMemory

/// Limit of the control group (version 2) as visible inside a container; `none` if there is none.
double ControlGroupLimit(double none) {
    const KernelText limit("/sys/fs/cgroup/memory.max");
    char *end = nullptr;
    const double bytes = std::strtod(limit.text, &end);
    return end != limit.text ? bytes : none;  // "max" does not parse as a number
}

}  // namespace

double UsableMemory() {
    const double bytes = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
    return std::min({bytes, LimitOf(RLIMIT_AS), LimitOf(RLIMIT_DATA), ControlGroupLimit(bytes)});
}

double AvailableMemory() {
    // In pages: total, resident, shared, code, 0, data and stack.
    double all = 0, resident = 0, shared = 0, code = 0, none = 0, data = 0;
    std::sscanf(KernelText("/proc/self/statm").text, "%lf %lf %lf %lf %lf %lf", &all, &resident, &shared, &code, &none,
                &data);
    const auto page = double(sysconf(_SC_PAGESIZE));
    double bytes = UsableMemory();
    constexpr const char *kAvailable = "MemAvailable:";
    const KernelText machine("/proc/meminfo");
    if (const char *at = std::strstr(machine.text, kAvailable))
        bytes = std::min(bytes, 1024 * std::strtod(at + std::strlen(kAvailable), nullptr));
    bytes = std::min(bytes, ControlGroupLimit(std::numeric_limits<double>::infinity()) - page * resident);
    bytes = std::min({bytes, LimitOf(RLIMIT_AS) - page * all, LimitOf(RLIMIT_DATA) - page * data});
    return std::max(0.0, bytes);
}

void LimitMemory(double bytes) {
    rlimit limit{};
    if (getrlimit(RLIMIT_DATA, &limit) != 0) return;
    const auto wanted = rlim_t(std::min(bytes, 1e18));
    if (limit.rlim_cur != RLIM_INFINITY && limit.rlim_cur <= wanted) return;
    limit.rlim_cur = limit.rlim_max == RLIM_INFINITY ? wanted : std::min(wanted, limit.rlim_max);
    isLimited = setrlimit(RLIMIT_DATA, &limit) == 0;
}

std::string OutOfMemoryText(const std::string &phase) {
    return fmt::format("there is not enough memory{}{}: this process can use {}{}.", phase.empty() ? "" : " for ",
                       phase, BytesText(UsableMemory()), isLimited ? "; a larger --memory-limit allows more" : "");
}

}  // namespace pbrt
