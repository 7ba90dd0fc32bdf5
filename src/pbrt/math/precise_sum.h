#pragma once
#include <cmath>

namespace pbrt {

/// Double-double accumulator: the rounded sum and its rounding error (Knuth's two-sum).
///
/// The sum is exact if every addend is a multiple of 2^q and no partial sum reaches 2^(q + 105). It is then
/// bit-identical for any order and any partition of the addends. Products of two floats qualify unless they differ by
/// more than a factor of about 2^55. Otherwise each addition has an error of at most 2^-105 of the sum.
class PreciseSum {
  public:
    void Add(double x) {
        const TwoSum first(high_, x);
        if (!std::isfinite(first.sum)) [[unlikely]] {
            high_ = first.sum;  // same as a plain sum
            low_ = 0;
            return;
        }
        const TwoSum second(first.sum, low_ + first.rest);
        high_ = second.sum;
        low_ = second.rest;
    }
    /// An empty sum plus another is bit-identical to the other.
    void operator+=(const PreciseSum &other) {
        Add(other.high_);
        if (other.low_ != 0) Add(other.low_);
    }
    double Value() const { return high_; }
    double Rest() const { return low_; }  ///< exact sum: Value() + Rest()

  private:
    struct TwoSum {
        double sum, rest;  ///< a + b == sum + rest exactly
        TwoSum(double a, double b) : sum(a + b) {
            const double fromB = sum - a;
            rest = (a - (sum - fromB)) + (b - fromB);
        }
    };
    double high_ = 0, low_ = 0;
};

/// Sample variance (divided by n - 1) from sum and sum of squares; 0 for n < 2. Subtracts with 113 bits, more than both
/// sums have.
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
