#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "ext/lab/text_output.h"
#include "pbrt/images/metrics.h"

namespace ext::lab {
using namespace pbrt;

/// Error measures of every round, in results file order. The two Abs are for the paper's tables only.
enum class Measure { RelL2, MSE, MRSE, MAE, SMAPE, FLIP, RelL2Trimmed, RelL2Abs, RelL2AbsTrimmed };
constexpr size_t MeasureCount = 9;
constexpr std::array<const char *, MeasureCount> MeasureNames = {
    "relL2", "MSE", "MRSE", "MAE", "SMAPE", "FLIP", "relL2Trimmed", "relL2Abs", "relL2AbsTrimmed"};
using Measures = std::array<double, MeasureCount>;
template <class T>
const T &Get(const std::array<T, MeasureCount> &values, Measure which) {
    return values[size_t(which)];
}

/// By the names of the measures. Reading throws Json::exception if one is missing; what is no number becomes NaN.
Json ToJson(const Measures &measures);
Measures MeasuresFromJson(const Json &json);

/// Compares images with one reference (R, G, B of equal resolution).
class MeasuringReference {
  public:
    explicit MeasuringReference(const Image &reference) : reference_(reference), flip_(reference) {}
    Measures Compare(const Image &image) const;

  private:
    Image reference_;
    FlipReference flip_;
};

struct Summary {
    size_t count = 0;
    double mean = 0;
    double stdDev = 0;         ///< of one run; 0 for fewer than two
    double standardError = 0;  ///< of the mean; 0 (unknown) for fewer than two
};
Summary Summarize(std::span<const double> values);

/// True if trimmed relL2 is lower than relL2 by more than a factor of 2: fireflies dominate the error.
inline bool FirefliesDecide(double relL2, double trimmedRelL2) { return relL2 > 2 * trimmedRelL2; }

/// True if the mean of `a` is lower than that of `b` by a one-sided t-test at `level`, with one value per seed. Runs of
/// equal seed share the camera's random numbers: for equal seed counts of at least `kSeedsToPair`, per-seed differences
/// are tested. Otherwise runs are treated as independent, which is conservative (Welch's test of the logarithms, their
/// spread to first order). False if either has fewer than two values.
bool LowerBeyondNoise(std::span<const double> a, std::span<const double> b, double level = 0.05);
inline constexpr size_t kSeedsToPair = 5;

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

    /// Error at a cost; empty before the first point or without points.
    std::optional<double> ErrorAt(double cost) const;
    /// Minimum cost for an error; empty if the first point is already below it (the value would then be a guess).
    std::optional<double> CostToReach(double error) const;
    const std::vector<CurvePoint> &Points() const { return points_; }  ///< sorted by cost, levelled

  private:
    std::vector<CurvePoint> points_;
    double fixedCost_;
};

/// Mean curve of several runs: point i is the mean cost and error of the i-th points; as long as the shortest run.
std::vector<CurvePoint> MeanCurve(std::span<const std::vector<CurvePoint>> runs);

/// Cost of `other` for the error of `mine` at its last point, over the cost of that point; above 1 if `mine` is faster.
/// If the first point of `other` is already better: the ratio at that point's error, extrapolating `mine` where needed.
std::optional<double> SpeedUpToEqualError(const ErrorCurve &mine, const ErrorCurve &other);

/// Error ratio of `mine` to `other` at the largest cost measured for both (interpolated).
std::optional<double> ErrorRatioAtEqualCost(const ErrorCurve &mine, const ErrorCurve &other);

/// 1 / (error x seconds); 0 if either is not positive.
inline double Efficiency(double error, double seconds) { return error > 0 && seconds > 0 ? 1 / (error * seconds) : 0; }

}  // namespace ext::lab
