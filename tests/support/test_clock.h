#pragma once
#include <atomic>
#include <chrono>

namespace pbrt::test {

/// A clock that moves only with Advance; Progress takes it as std::ref. May be read by other threads.
class TestClock {
  public:
    std::chrono::steady_clock::time_point operator()() const { return now_; }
    void Advance(std::chrono::duration<double> time) {
        now_ = now_.load() + std::chrono::round<std::chrono::nanoseconds>(time);
    }

  private:
    std::atomic<std::chrono::steady_clock::time_point> now_ = std::chrono::steady_clock::now();
};

}  // namespace pbrt::test
