#pragma once
#include <string>
#include <vector>

#include "pbrt/images/image.h"

namespace pbrt {

/// Image error measures over all pixels and channels.
enum class Metric { MAE, MSE, MRSE, RelL2 };
std::optional<Metric> ParseMetric(const std::string &name);

/// MAE: mean |x-r|. MSE: mean (x-r)^2. MRSE: mean (x-r)^2/(r+0.01)^2. RelL2 (the paper's): mean (x-r)^2/(r^2+0.01).
/// Not-finite terms are skipped and counted in `skipped` (may be null). `errorImage` (may be null) gets the terms.
double ImageError(const Image &image, const Image &reference, Metric metric, Image *errorImage = nullptr,
                  size_t *skipped = nullptr);

}  // namespace pbrt
