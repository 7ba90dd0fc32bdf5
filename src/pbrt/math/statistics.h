#pragma once
#include <cstddef>

namespace pbrt {

/// Two-sided p-value of Student's t with `dof` degrees of freedom (need not be whole); 1 if dof <= 0 or t is NaN.
double StudentTwoSidedP(double t, double dof);
/// t > 0 with StudentTwoSidedP(t, dof) == p, p in (0, 1]; infinity if dof <= 0.
double StudentCritical(double p, double dof);
/// Two-sided p-value of a standard normal z, and its inverse (>= 0).
double NormalTwoSidedP(double z);
double NormalCritical(double p);
/// Level for each of n tests so that the chance of any false alarm is `level` (Sidak), and its inverse SidakP: the
/// chance that the smallest of n p-values is at most p.
double SidakLevel(double level, size_t n);
double SidakP(double p, size_t n);

/// Mean and variance of numbers that come one by one (Welford).
class RunningMoments {
  public:
    void Add(double x) {
        ++count_;
        double d = x - mean_;
        mean_ += d / static_cast<double>(count_);
        squares_ += d * (x - mean_);
    }
    /// Adds all numbers of the other (Chan, Golub and LeVeque 1979). If this one has none yet, it becomes an exact copy
    /// of the other.
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
    /// Sample variance (divided by n - 1); 0 for fewer than two numbers.
    double Variance() const { return count_ > 1 ? squares_ / static_cast<double>(count_ - 1) : 0; }

  private:
    size_t count_ = 0;
    double mean_ = 0, squares_ = 0;
};

}  // namespace pbrt
