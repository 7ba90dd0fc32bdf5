#pragma once
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
        mean_ += d / static_cast<double>(count_);
        squares_ += d * (x - mean_);
    }
    /// Merges (Chan, Golub and LeVeque 1979). An empty accumulator becomes an exact copy of the other.
    void operator+=(const RunningMoments &other) {
        if (other.count_ == 0) return;
        if (count_ == 0) {
            *this = other;
            return;
        }
        const double a = static_cast<double>(count_), b = static_cast<double>(other.count_), d = other.mean_ - mean_;
        count_ += other.count_;
        mean_ += d * (b / (a + b));
        squares_ += other.squares_ + d * d * (a * b / (a + b));
    }
    size_t Count() const { return count_; }
    double Mean() const { return mean_; }
    /// Sample variance (divided by n - 1); 0 for fewer than two values.
    double Variance() const { return count_ > 1 ? squares_ / static_cast<double>(count_ - 1) : 0; }

  private:
    size_t count_ = 0;
    double mean_ = 0, squares_ = 0;
};

}  // namespace pbrt
