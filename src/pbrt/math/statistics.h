#pragma once
#include <cmath>
#include <cstddef>

namespace pbrt {

/// Two-sided p-value of Student's t with `dof` (real) degrees of freedom; 1 if dof <= 0 or t is NaN.
double StudentTwoSidedP(double t, double dof);
/// Inverse: t > 0 with StudentTwoSidedP(t, dof) == p, p in (0, 1]; infinity if dof <= 0.
double StudentCritical(double p, double dof);
/// z >= 0 whose two-sided p-value as a standard normal is p.
double NormalCritical(double p);
/// Per-test level of n tests for a family-wise false alarm rate `level` (Sidak). The inverse SidakP is the probability
/// that the smallest of n p-values is at most p.
double SidakLevel(double level, size_t n);
double SidakP(double p, size_t n);

/// Online mean and variance (Welford).
class RunningMoments {
  public:
    void Add(double x) {
        ++count_;
        double d = x - mean_;
        mean_ += d / double(count_);
        squares_ += d * (x - mean_);
    }
    /// Merges (Chan, Golub and LeVeque 1979). An empty accumulator becomes an exact copy of the other.
    void operator+=(const RunningMoments &other) {
        if (other.count_ == 0) return;
        if (count_ == 0) {
            *this = other;
            return;
        }
        const double a = double(count_), b = double(other.count_), d = other.mean_ - mean_;
        count_ += other.count_;
        mean_ += d * (b / (a + b));
        squares_ += other.squares_ + d * d * (a * b / (a + b));
    }
    size_t Count() const { return count_; }
    double Mean() const { return mean_; }
    /// Sample variance (divided by n - 1); 0 for fewer than two values.
    double Variance() const { return count_ > 1 ? squares_ / double(count_ - 1) : 0; }

  private:
    size_t count_ = 0;
    double mean_ = 0, squares_ = 0;
};

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

/// Sample variance (divided by n - 1) from sum and sum of squares; 0 for n < 2. Subtracts with 113 bits.
inline double VarianceOf(const PreciseSum &sum, const PreciseSum &squares, double n) {
    if (!(n > 1)) return 0;
    const auto whole = [](const PreciseSum &s) { return __float128(s.Value()) + __float128(s.Rest()); };
    const __float128 s = whole(sum);
    return std::fmax(0.0, double((whole(squares) - s * s / __float128(n)) / __float128(n - 1)));
}

}  // namespace pbrt
