#pragma once
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>

namespace pbrt {

/// Fixed-point sum of 320 bits, which covers all floats. Integer addition is order-independent and safe for concurrent
/// threads. Addends are rounded to multiples of 2^-144, an error of at most 2.3e-44. The sum wraps around beyond 2^175;
/// with addends limited to kMaxAddend, 2^31 of the largest fit.
class FixedSum {
  public:
    static constexpr double kMaxAddend = 0x1p144;

    static bool Holds(double x) { return std::abs(x) <= kMaxAddend; }  // false for NaN

    /// Thread-safe. Requires Holds(x).
    void Add(double x) {
        // |x| is mantissa * 2^(shift - kFractionBits).
        const auto bits = std::bit_cast<uint64_t>(x);
        uint64_t mantissa = (bits & (kImplicitBit - 1)) | kImplicitBit;
        int shift = int(bits >> 52 & 0x7ff) - (1023 + 52) + kFractionBits;
        if (shift < 0) {
            mantissa = shift < -53 ? 0 : (mantissa + (uint64_t{1} << (-shift - 1))) >> -shift;
            shift = 0;
        }
        const size_t word = shift / 64;
        const int within = shift % 64;
        const auto add = [&](auto &&addTo) {
            // In any order of threads, a word wraps around exactly as often as the true sum carries.
            uint64_t carry = addTo(word, mantissa << within) + (mantissa >> 1 >> (63 - within));
            for (size_t i = word + 1; carry != 0 && i < kWords; ++i) carry = addTo(i, carry);
        };
        if (x < 0)
            add([this](size_t i, uint64_t addend) {
                return uint64_t{std::atomic_ref(words_[i]).fetch_sub(addend, std::memory_order_relaxed) < addend};
            });
        else
            add([this](size_t i, uint64_t addend) {
                return uint64_t{std::atomic_ref(words_[i]).fetch_add(addend, std::memory_order_relaxed) > ~addend};
            });
    }
    /// Not thread-safe.
    FixedSum &operator+=(const FixedSum &other) {
        bool carry = false;
        for (size_t i = 0; i < kWords; ++i) {
            const uint64_t addend = other.words_[i] + (carry ? 1 : 0);
            carry = addend < (carry ? 1 : 0);
            words_[i] += addend;
            carry |= words_[i] < addend;
        }
        return *this;
    }
    double Value() const {
        // A negative sum is -1 minus the number with inverted bits.
        const uint64_t flip = words_.back() >> 63 != 0 ? ~uint64_t{0} : 0;
        double value = 0;
        for (size_t i = kWords; i-- > 0;) value = value * 0x1p64 + double(words_[i] ^ flip);
        return std::ldexp(flip ? -1 - value : value, -kFractionBits);
    }
    bool operator==(const FixedSum &) const = default;

  private:
    static constexpr int kFractionBits = 144;
    static constexpr size_t kWords = 5;
    static constexpr uint64_t kImplicitBit = uint64_t{1} << 52;
    std::array<uint64_t, kWords> words_{};  ///< two's complement, lowest first
};

}  // namespace pbrt
