#pragma once
#include <chrono>
#include <functional>
#include <thread>

namespace pbrt::test {

/// Polls until the condition holds; false after half a minute.
inline bool WaitUntil(const std::function<bool()> &condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
}

}  // namespace pbrt::test
