#pragma once
#include <string>
#include <vector>

#include "pbrt/images/image.h"

namespace pbrt {

/// Image error measures over all pixels and channels; the two FLIPs are over pixels and need R, G and B.
enum class Metric { MAE, MSE, MRSE, RelL2, SMAPE, FLIP, HdrFLIP };
std::optional<Metric> ParseMetric(const std::string &name);
const std::string &MetricName(Metric metric);
/// All names that ParseMetric knows: MAE, MSE, MRSE, relL2, SMAPE, FLIP, HDR-FLIP.
const std::vector<std::string> &MetricNames();

/// MAE: mean |x-r|. MSE: mean (x-r)^2. MRSE: mean (x-r)^2/(r+0.01)^2. RelL2 (the paper's): mean (x-r)^2/(r^2+0.01).
/// SMAPE: mean |x-r|/((|x|+|r|)/2 + 0.01), between 0 and 2.
/// FLIP: values clamped to [0, 1], as stock pbrt-v4 does. HdrFLIP: largest over exposures (see flip.h).
/// Not-finite terms are skipped and counted in `skipped` (may be null); for FLIP not-finite values count as 0.
/// `errorImage` (may be null) gets the terms: the channels of the images, or the channel Y for FLIP.
double ImageError(const Image &image, const Image &reference, Metric metric, Image *errorImage = nullptr,
                  size_t *skipped = nullptr);

/// relL2 without the worst pixels: the ceil(share x pixels) pixels with the largest terms are left out. A pixel's term
/// is the mean over its channels; not-finite ones are skipped first.
double TrimmedRelL2(const Image &image, const Image &reference, double share = 0.001, size_t *skipped = nullptr);

}  // namespace pbrt
