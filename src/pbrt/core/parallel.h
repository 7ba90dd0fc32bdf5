#pragma once
#include <cstdint>
#include <functional>
#include <memory>

namespace pbrt {

/// Limits all functions below to `n` threads (0: all cores) during its lifetime. Only one may exist at a time.
class ThreadLimit {
  public:
    explicit ThreadLimit(int n);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit &) = delete;
    ThreadLimit &operator=(const ThreadLimit &) = delete;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Maximum number of threads of the loops below.
int ThreadCount();

/// Index of the calling thread inside a parallel loop, in [0, ThreadCount()); 0 outside. For per-thread scratch only:
/// images must not depend on it.
int ThreadIndex();

/// Calls body(begin, end) over disjoint ranges that cover [0, count). Only ranges longer than `grain` are split, so
/// none is shorter than half of it (unless `count` is). Exceptions propagate to the caller. The split is arbitrary:
/// results must not depend on it.
void ParallelFor(int64_t count, int64_t grain, const std::function<void(int64_t, int64_t)> &body);

/// Calls body(i) for i in [0, count), each as its own task (tiles, files).
void ParallelForEach(int64_t count, const std::function<void(int64_t)> &body);
/// The same in tasks of about `grain` indices (ParallelFor), for short bodies.
void ParallelForEach(int64_t count, int64_t grain, auto &&body) {
    ParallelFor(count, grain, [&](int64_t begin, int64_t end) {
        for (int64_t i = begin; i < end; ++i) body(i);
    });
}

/// Runs both, possibly concurrently.
void ParallelInvoke(const std::function<void()> &a, const std::function<void()> &b);

}  // namespace pbrt
