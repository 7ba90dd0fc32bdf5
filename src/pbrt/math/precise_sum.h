#pragma once
#include <cmath>

namespace pbrt {

/// A sum of doubles kept as two of them: the sum rounded to double, and what rounding left over (Knuth's two-sum).
///
/// If every addend is a multiple of 2^q and no partial sum reaches 2^(q + 105), the sum is exact: then it does not
/// depend on the order of the addends nor on how they were divided into sums that were added up later, to the last bit.
/// Products of two floats are such multiples unless they differ by more than a factor of about 2^55. Beyond that each
/// addition is off by at most 2^-105 of the sum.
class PreciseSum {
  public:
    void Add(double x) {
        const TwoSum first(high_, x);
        if (!std::isfinite(first.sum)) [[unlikely]] {
            high_ = first.sum;  // as a plain sum would have it
            low_ = 0;
            return;
        }
        const TwoSum second(first.sum, low_ + first.rest);
        high_ = second.sum;
        low_ = second.rest;
    }
    /// An empty sum plus another equals the other to the bit.
    void operator+=(const PreciseSum &other) {
        Add(other.high_);
        if (other.low_ != 0) Add(other.low_);
    }
    double Value() const { return high_; }
    double Rest() const { return low_; }  ///< the sum is Value() + Rest()

  private:
    struct TwoSum {
        double sum, rest;  ///< a + b == sum + rest, exactly
        TwoSum(double a, double b) : sum(a + b) {
            const double fromB = sum - a;
            rest = (a - (sum - fromB)) + (b - fromB);
        }
    };
    double high_ = 0, low_ = 0;
};

/// The sample variance of n numbers (divided by n - 1) from their sum and the sum of their squares; 0 for fewer than
/// two. The difference is taken with 113 bits, more than both sums have.
inline double VarianceOf(const PreciseSum &sum, const PreciseSum &squares, double n) {
    if (!(n > 1)) return 0;
    const auto whole = [](const PreciseSum &s) {
        return static_cast<__float128>(s.Value()) + static_cast<__float128>(s.Rest());
    };
    const __float128 s = whole(sum);
    return std::fmax(0.0, static_cast<double>((whole(squares) - s * s / static_cast<__float128>(n)) /
                                              static_cast<__float128>(n - 1)));
}

}  // namespace pbrt
