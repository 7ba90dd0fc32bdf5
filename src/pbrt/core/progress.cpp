#include "pbrt/core/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace pbrt {
namespace {

std::string Duration(double seconds) {
    if (!(seconds >= 0) || !std::isfinite(seconds)) return "--:--";
    auto s = int64_t(seconds + 0.5);
    if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
    return fmt::format("{:02}:{:02}", s / 60, s % 60);
}

class BarSink final : public ProgressSink {
  public:
    void Show(const std::string &phase, double fraction, double elapsed, double remaining) override {
        constexpr int kCells = 30;
        int full = int(kCells * std::clamp(fraction, 0.0, 1.0));
        std::fprintf(stderr, "\r\033[K%-10s [%s%s] %3d%%  %s elapsed, %s left", phase.c_str(),
                     std::string(full, '#').c_str(), std::string(kCells - full, '.').c_str(), int(100 * fraction),
                     Duration(elapsed).c_str(), Duration(remaining).c_str());
        std::fflush(stderr);
    }
    void PhaseDone(const std::string &phase, double elapsed) override {
        std::fprintf(stderr, "\r\033[K%-10s done in %.2f s\n", phase.c_str(), elapsed);
    }
};

class LineSink final : public ProgressSink {
  public:
    void Show(const std::string &phase, double fraction, double elapsed, double remaining) override {
        if (phase == last_ && elapsed < lastShown_ + 5) return;
        if (elapsed < 2) return;
        last_ = phase;
        lastShown_ = elapsed;
        std::fprintf(stderr, "%s: %d%%, %s elapsed, %s left\n", phase.c_str(), int(100 * fraction),
                     Duration(elapsed).c_str(), Duration(remaining).c_str());
    }
    void PhaseDone(const std::string &phase, double elapsed) override {
        last_.clear();
        std::fprintf(stderr, "%s: done in %.2f s\n", phase.c_str(), elapsed);
    }

  private:
    std::string last_;
    double lastShown_ = 0;
};

}  // namespace

std::unique_ptr<ProgressSink> MakeTerminalProgress(bool quiet) {
    if (quiet) return nullptr;
    if (isatty(STDERR_FILENO)) return std::make_unique<BarSink>();
    return std::make_unique<LineSink>();
}

}  // namespace pbrt
