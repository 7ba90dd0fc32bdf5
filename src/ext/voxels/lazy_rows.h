#pragma once
#include <atomic>
#include <cstdint>
#include <ctime>
#include <memory>
#include <span>

namespace ext {

/// Arrays of equal length that are made when first asked for, by whichever thread asks. A row's content must depend on
/// its index only: threads that want the same row at once each make it, one publishes, the others throw theirs away,
/// and nobody waits. So the result is the same for any timing. A row that exists costs one load.
template <class T>
class LazyRows {
  public:
    LazyRows() = default;
    ~LazyRows() { Clear(); }
    LazyRows(const LazyRows &) = delete;
    LazyRows &operator=(const LazyRows &) = delete;

    /// Deletes all rows and sets their number and length. Not while rows are in use.
    void Reset(size_t rows, size_t length) {
        Clear();
        rows_ = std::make_unique<std::atomic<T *>[]>(rows);
        count_ = rows;
        length_ = length;
        filled_ = discarded_ = nanoseconds_ = 0;
    }

    /// The row; if it does not exist, `fill` makes it: it gets a span of T with unspecified values and sets them all.
    template <class Fill>
    std::span<const T> Get(size_t row, const Fill &fill) const {
        const T *values = rows_[row].load(std::memory_order_acquire);
        if (!values) [[unlikely]]
            values = Make(row, fill);
        return {values, length_};
    }
    bool IsFilled(size_t row) const { return rows_[row].load(std::memory_order_acquire) != nullptr; }

    size_t Size() const { return count_; }
    size_t Filled() const { return static_cast<size_t>(filled_.load()); }
    /// Rows thrown away because another thread published the same row first.
    size_t Discarded() const { return static_cast<size_t>(discarded_.load()); }
    /// CPU time spent in `fill`, added up over threads.
    double FillThreadSeconds() const { return static_cast<double>(nanoseconds_.load()) * 1e-9; }
    size_t Bytes() const { return count_ * sizeof(T *) + Filled() * length_ * sizeof(T); }

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
