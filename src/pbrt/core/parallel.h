#pragma once
#include <cstdint>
#include <functional>
#include <memory>

namespace pbrt {

/// Limits the threads of all functions below to `n` (0: all cores) while the object lives. Only one may exist at a
/// time.
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

/// Number of threads that parallel loops may use.
int ThreadCount();

/// Index of the calling thread inside a parallel loop, in [0, ThreadCount()); 0 outside. For per-thread scratch only:
/// nothing that reaches an image may depend on it.
int ThreadIndex();

/// Calls body(begin, end) over disjoint ranges that cover [0, count). Only ranges longer than `grain` are split, so
/// that none is shorter than half of it (unless `count` is). Exceptions of the body reach the caller. The split is
/// arbitrary: results must not depend on it.
void ParallelFor(int64_t count, int64_t grain, const std::function<void(int64_t, int64_t)> &body);

/// Calls body(i) for every i of [0, count), each as its own task (tiles, files).
void ParallelForEach(int64_t count, const std::function<void(int64_t)> &body);

/// Runs both, possibly at once.
void ParallelInvoke(const std::function<void()> &a, const std::function<void()> &b);

}  // namespace pbrt
