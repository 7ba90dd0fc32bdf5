#pragma once
#include <optional>
#include <span>
#include <vector>

namespace ext::lab {

struct CurvePoint {
    double cost = 0;   ///< seconds or samples per pixel
    double error = 0;  ///< relL2 or another squared measure, which falls with 1/cost
};

/// Error against cost of one sampler: straight lines in log-log between the points. After the last point the error is
/// continued as 1 / (cost - fixedCost), the rate of a Monte Carlo mean; before the first point it is not known.
class ErrorCurve {
  public:
    /// `points` in any order; those whose cost or error is not positive and finite are left out. fixedCost: seconds of
    /// preparation in every cost (0 for samples). Measured errors jitter; a rise with the cost is levelled
    /// (pool-adjacent-violators on the logarithms), so the curve falls.
    explicit ErrorCurve(std::vector<CurvePoint> points, double fixedCost = 0);

    struct Reading {
        double value = 0;
        bool extrapolated = false;  ///< beyond the last point
    };
    /// Returns the error at a cost; nothing before the first point or without points.
    std::optional<Reading> ErrorAt(double cost) const;
    /// Returns the least cost that reaches an error; nothing if the first point is already below it (`value` then would
    /// be a guess).
    std::optional<Reading> CostToReach(double error) const;
    const std::vector<CurvePoint> &Points() const { return points_; }  ///< sorted by cost, levelled
    bool Empty() const { return points_.empty(); }

  private:
    std::vector<CurvePoint> points_;
    double fixedCost_;
};

/// Returns the mean curve of several runs: point i is the mean cost and mean error of the i-th points; as long as the
/// shortest.
std::vector<CurvePoint> MeanCurve(std::span<const std::vector<CurvePoint>> runs);

/// Returns the cost that `other` needs for the error of `mine` at its last point, over the cost of that point; above 1
/// if `mine` is faster. If the first point of `other` is already better, the ratio at the error of that point, with
/// `mine` extrapolated where needed.
std::optional<ErrorCurve::Reading> SpeedUpToEqualError(const ErrorCurve &mine, const ErrorCurve &other);

/// Returns the error of `mine` over that of `other` at the largest cost both have measured (interpolated).
std::optional<double> ErrorRatioAtEqualCost(const ErrorCurve &mine, const ErrorCurve &other);

/// Returns 1 / (error x seconds); 0 if either is not positive.
double Efficiency(double error, double seconds);

}  // namespace ext::lab
