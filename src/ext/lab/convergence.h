#pragma once
#include <optional>
#include <span>
#include <vector>

namespace ext::lab {

struct CurvePoint {
    double cost = 0;   ///< seconds or samples per pixel
    double error = 0;  ///< relL2 or another squared measure, proportional to 1/cost
};

/// Error against cost of one sampler, piecewise linear in log-log. Extrapolated after the last point as 1 / (cost -
/// fixedCost), the Monte Carlo rate; undefined before the first.
class ErrorCurve {
  public:
    /// `points` in any order; costs or errors that are not positive and finite are removed. fixedCost: preparation
    /// seconds in every cost (0 for samples). Increases by measurement noise are levelled (pool-adjacent-violators on
    /// the logarithms), so the curve is monotone.
    explicit ErrorCurve(std::vector<CurvePoint> points, double fixedCost = 0);

    struct Reading {
        double value = 0;
        bool extrapolated = false;  ///< beyond the last point
    };
    /// Error at a cost; empty before the first point or without points.
    std::optional<Reading> ErrorAt(double cost) const;
    /// Minimum cost for an error; empty if the first point is already below it (`value` would then be a guess).
    std::optional<Reading> CostToReach(double error) const;
    const std::vector<CurvePoint> &Points() const { return points_; }  ///< sorted by cost, levelled
    bool Empty() const { return points_.empty(); }

  private:
    std::vector<CurvePoint> points_;
    double fixedCost_;
};

/// Mean curve of several runs: point i is the mean cost and error of the i-th points; as long as the shortest run.
std::vector<CurvePoint> MeanCurve(std::span<const std::vector<CurvePoint>> runs);

/// Cost of `other` for the error of `mine` at its last point, over the cost of that point; above 1 if `mine` is faster.
/// If the first point of `other` is already better: the ratio at that point's error, extrapolating `mine` where needed.
std::optional<ErrorCurve::Reading> SpeedUpToEqualError(const ErrorCurve &mine, const ErrorCurve &other);

/// Error ratio of `mine` to `other` at the largest cost measured for both (interpolated).
std::optional<double> ErrorRatioAtEqualCost(const ErrorCurve &mine, const ErrorCurve &other);

/// 1 / (error x seconds); 0 if either is not positive.
double Efficiency(double error, double seconds);

}  // namespace ext::lab
