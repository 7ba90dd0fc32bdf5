#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "ext/lab/text_output.h"
#include "pbrt/images/flip.h"
#include "pbrt/images/image.h"

namespace ext::lab {

using namespace pbrt;

/// Error measures of every round, in results file order. The two Abs are for the paper's tables only.
enum class Measure { RelL2, MSE, MRSE, MAE, SMAPE, FLIP, RelL2Trimmed, RelL2Abs, RelL2AbsTrimmed };
constexpr size_t MeasureCount = 9;
constexpr std::array<const char *, MeasureCount> MeasureNames = {
    "relL2", "MSE", "MRSE", "MAE", "SMAPE", "FLIP", "relL2Trimmed", "relL2Abs", "relL2AbsTrimmed"};
using Measures = std::array<double, MeasureCount>;
inline double Get(const Measures &m, Measure which) { return m[static_cast<size_t>(which)]; }

Json ToJson(const Measures &measures);
Measures MeasuresFromJson(const Json &json);

/// Compares images with one reference (R, G, B of equal resolution).
class MeasuringReference {
  public:
    explicit MeasuringReference(Image reference);
    Measures Compare(const Image &image) const;
    const Image &Picture() const { return reference_; }

  private:
    Image reference_;
    std::unique_ptr<FlipReference> flip_;
};

struct Summary {
    size_t count = 0;
    double mean = 0;
    double stdDev = 0;         ///< of one run; 0 for fewer than two
    double standardError = 0;  ///< of the mean; 0 (unknown) for fewer than two
};
Summary Summarize(std::span<const double> values);

/// True if trimmed relL2 is lower than relL2 by more than `factor`: fireflies dominate the error.
bool FirefliesDecide(double relL2, double trimmedRelL2, double factor = 2);

/// True if the mean of `a` is lower than that of `b` by a one-sided t-test at `level`, with one value per seed. Runs of
/// equal seed share the camera's random numbers: for equal seed counts of at least `kSeedsToPair`, per-seed differences
/// are tested. Otherwise runs are treated as independent, which is conservative (Welch's test of the logarithms, their
/// spread to first order). False if either has fewer than two values.
bool LowerBeyondNoise(std::span<const double> a, std::span<const double> b, double level = 0.05);
inline constexpr size_t kSeedsToPair = 5;

}  // namespace ext::lab
