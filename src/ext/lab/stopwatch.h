#pragma once
#include <chrono>
#include <ctime>

namespace pbrt::lab {

/// Seconds by the monotonic clock, and CPU seconds of all threads of the process.
struct TimeSpent {
    double wall = 0, cpu = 0;
    TimeSpent &operator+=(const TimeSpent &o) {
        wall += o.wall;
        cpu += o.cpu;
        return *this;
    }
};

class Stopwatch {
  public:
    TimeSpent Elapsed() const {
        return {std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count(), CpuSeconds() - cpu_};
    }

  private:
    static double CpuSeconds() {
        timespec t{};
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
        return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    }
    std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
    double cpu_ = CpuSeconds();
};

}  // namespace pbrt::lab
