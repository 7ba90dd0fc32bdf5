#pragma once
#include <atomic>
#include <cstdint>
#include <ctime>
#include <memory>
#include <span>

#include "pbrt/core/parallel.h"

namespace ext {

/// Arrays of equal length, created lazily by any thread. A row must depend on its index only: threads that race for a
/// row each create it, one publishes, the others discard theirs, and none waits. The result is independent of timing.
/// Access to an existing row costs one load.
template <class T>
class LazyRows {
  public:
    LazyRows() = default;
    ~LazyRows() { Clear(); }
    LazyRows(const LazyRows &) = delete;
    LazyRows &operator=(const LazyRows &) = delete;

    /// Deletes all rows and sets their number and length. Not thread-safe.
    void Reset(size_t rows, size_t length) {
        Clear();
        rows_ = std::make_unique<std::atomic<T *>[]>(rows);
        count_ = rows;
        length_ = length;
        filled_ = discarded_ = nanoseconds_ = 0;
    }

    /// Returns the row, creating it with `fill` if missing, which must set every element of an uninitialized span of T.
    std::span<const T> Get(size_t row, const auto &fill) const {
        const T *values = rows_[row].load(std::memory_order_acquire);
        if (!values) [[unlikely]]
            values = Make(row, fill);
        return {values, length_};
    }
    bool IsFilled(size_t row) const { return rows_[row].load(std::memory_order_acquire) != nullptr; }

    size_t Size() const { return count_; }
    size_t Filled() const { return filled_.load(); }
    /// Rows discarded because another thread published first.
    size_t Discarded() const { return discarded_.load(); }
    /// CPU time in `fill`, summed over threads.
    double FillThreadSeconds() const { return double(nanoseconds_.load()) * 1e-9; }
    size_t Bytes() const { return count_ * sizeof(T *) + Filled() * length_ * sizeof(T); }
    /// Adds times and numbers of rows that are voxels to a light sampler's report.
    void Report(auto &report, double prepareSeconds) const {
        report["prepassSeconds"] = 0.0;
        // Voxels are filled during rendering; a thread that fills does not render.
        report["buildSeconds"] = prepareSeconds + FillThreadSeconds() / std::max(1, pbrt::ThreadCount());
        report["fillThreadSeconds"] = FillThreadSeconds();
        report["voxels"] = Size();
        report["voxelsFilled"] = Filled();
        report["voxelsFilledTwice"] = Discarded();
    }

  private:
    static int64_t ThreadNanoseconds() {
        timespec t{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
        return int64_t(t.tv_sec) * 1000000000 + t.tv_nsec;
    }
    template <class Fill>
    [[gnu::noinline]] const T *Make(size_t row, const Fill &fill) const {
        int64_t start = ThreadNanoseconds();
        std::unique_ptr<T[]> made(new T[length_]);
        fill(std::span<T>(made.get(), length_));
        nanoseconds_ += ThreadNanoseconds() - start;
        T *expected = nullptr;
        if (!rows_[row].compare_exchange_strong(expected, made.get(), std::memory_order_acq_rel,
                                                std::memory_order_acquire)) {
            ++discarded_;
            return expected;
        }
        ++filled_;
        return made.release();
    }
    void Clear() {
        for (size_t i = 0; i < count_; ++i) delete[] rows_[i].load();
        count_ = 0;
    }

    std::unique_ptr<std::atomic<T *>[]> rows_;
    size_t count_ = 0, length_ = 0;
    mutable std::atomic<int64_t> filled_{0}, discarded_{0}, nanoseconds_{0};
};

}  // namespace ext
