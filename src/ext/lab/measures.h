#pragma once
#include <array>
#include <memory>

#include "ext/lab/text_output.h"
#include "pbrt/images/flip.h"
#include "pbrt/images/image.h"

namespace ext::lab {
using namespace pbrt;

/// The error measures of every round, in the order of the results file. The two Abs are for the paper's tables only.
enum class Measure { RelL2, MSE, MRSE, MAE, SMAPE, FLIP, RelL2Trimmed, RelL2Abs, RelL2AbsTrimmed };
constexpr size_t MeasureCount = 9;
constexpr std::array<const char *, MeasureCount> MeasureNames = {
    "relL2", "MSE", "MRSE", "MAE", "SMAPE", "FLIP", "relL2Trimmed", "relL2Abs", "relL2AbsTrimmed"};
using Measures = std::array<double, MeasureCount>;
inline double Get(const Measures &m, Measure which) { return m[static_cast<size_t>(which)]; }

Json ToJson(const Measures &measures);
Measures MeasuresFromJson(const Json &json);

/// Compares pictures with one reference (R, G, B of the same resolution).
class MeasuringReference {
  public:
    explicit MeasuringReference(Image reference);
    Measures Compare(const Image &image) const;
    const Image &Picture() const { return reference_; }

  private:
    Image reference_;
    std::unique_ptr<FlipReference> flip_;
};

}  // namespace ext::lab
