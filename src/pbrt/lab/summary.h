#pragma once
#include <cstddef>
#include <optional>
#include <span>

namespace pbrt::lab {

/// Of one measure over the seeds.
struct Summary {
    size_t count = 0;
    double mean = 0;
    double stdDev = 0;         ///< of one run; 0 for fewer than two
    double standardError = 0;  ///< of the mean; 0 (unknown) for fewer than two
};
Summary Summarize(std::span<const double> values);

/// Fireflies decide an error if leaving out the worst 0.1 % of the pixels divides the mean relL2 by more than `factor`.
bool FirefliesDecide(double relL2, double trimmedRelL2, double factor = 2);

/// Is the mean of `a` lower than that of `b` beyond noise? Welch's t-test of the logarithms' first-order spread
/// (standardError / mean), one-sided at `level`. Never if either has fewer than two runs.
bool LowerBeyondNoise(const Summary &a, const Summary &b, double level = 0.05);

/// Who has the lowest mean error.
struct Contender {
    Summary error;
    bool eligible = true;  ///< false: biased, or the oracle
};
struct Winner {
    size_t index = 0;
    bool beyondNoise = false;  ///< LowerBeyondNoise against every other eligible contender
};
std::optional<Winner> FindWinner(std::span<const Contender> contenders);

}  // namespace pbrt::lab
