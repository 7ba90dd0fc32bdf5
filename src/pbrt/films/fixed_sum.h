#pragma once
#include <atomic>
#include <cmath>
#include <cstdint>

namespace pbrt {

/// A sum in fixed point of 128 bits: adding integers gives the same bits in any order, so any number of threads may add
/// at once. An addend is rounded to a multiple of 2^-56, an error of at most 2^-57 or 7e-18. The sum wraps around
/// beyond 2^71: addends are limited to kMaxAddend, so 2^21 of the largest have room.
class FixedSum {
  public:
    static constexpr double kMaxAddend = 1125899906842624.0;  ///< 2^50

    static bool Holds(double x) { return std::abs(x) <= kMaxAddend; }  // false for not-a-number

    /// From any thread. Holds(x) must be true.
    void Add(double x) {
        const FixedSum addend = Round(x);
        const uint64_t before = std::atomic_ref(low_).fetch_add(addend.low_, std::memory_order_relaxed);
        // In whatever order threads add, the low word wraps around exactly as often as the true sum carries.
        const uint64_t carry = before + addend.low_ < before ? 1 : 0;
        std::atomic_ref(high_).fetch_add(addend.high_ + carry, std::memory_order_relaxed);
    }
    /// From one thread, while no other thread adds.
    FixedSum &operator+=(const FixedSum &other) {
        low_ += other.low_;
        high_ += other.high_ + (low_ < other.low_ ? 1 : 0);
        return *this;
    }
    double Value() const {
        const bool isNegative = (high_ >> 63) != 0;
        const FixedSum size = isNegative ? Negative() : *this;
        const double value = std::ldexp(static_cast<double>(size.high_), 64 - kFractionBits) +
                             std::ldexp(static_cast<double>(size.low_), -kFractionBits);
        return isNegative ? -value : value;
    }
    bool operator==(const FixedSum &) const = default;

  private:
    static constexpr int kFractionBits = 56;

    static FixedSum Round(double x) {
        const double scaled = std::nearbyint(std::ldexp(std::abs(x), kFractionBits));
        FixedSum sum;
        sum.high_ = static_cast<uint64_t>(std::ldexp(scaled, -64));
        sum.low_ = static_cast<uint64_t>(scaled - std::ldexp(static_cast<double>(sum.high_), 64));
        return x < 0 ? sum.Negative() : sum;
    }
    FixedSum Negative() const {
        FixedSum n;
        n.low_ = ~low_ + 1;
        n.high_ = ~high_ + (n.low_ == 0 ? 1 : 0);
        return n;
    }
    uint64_t low_ = 0, high_ = 0;  ///< two's complement
};

}  // namespace pbrt
