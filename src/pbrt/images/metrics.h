#pragma once
#include <string>
#include <vector>

#include "pbrt/images/image.h"

namespace pbrt {

/// Image error measures over all pixels and channels; the two FLIPs are over pixels and need R, G and B.
enum class Metric { MAE, MSE, MRSE, RelL2, RelL2Abs, SMAPE, FLIP, HdrFLIP };
std::optional<Metric> ParseMetric(const std::string &name);
const std::string &MetricName(Metric metric);
/// All names that ParseMetric accepts: MAE, MSE, MRSE, relL2, relL2Abs, SMAPE, FLIP, HDR-FLIP.
const std::vector<std::string> &MetricNames();

/// The epsilon of relL2 for a reference whose values have the mean magnitude `mean`: 0.01 mean^2, so that relL2 does
/// not depend on the exposure; 0.01 for a black reference.
double RelL2Epsilon(double mean);
/// The same for the mean magnitude of the finite values of R, G, B, or of all channels if one of these is missing.
double RelL2Epsilon(const Image &reference);

/// MAE: mean |x-r|. MSE: mean (x-r)^2. MRSE: mean (x-r)^2/(r+0.01)^2, as in pbrt-v4. RelL2: mean (x-r)^2/(r^2+epsilon),
/// see RelL2Epsilon. RelL2Abs (the form of the paper's tables, depends on the exposure): mean (x-r)^2/(r^2+0.01).
/// SMAPE: mean |x-r|/((|x|+|r|)/2 + 0.01), between 0 and 2.
/// FLIP: values clamped to [0, 1], as stock pbrt-v4 does. HdrFLIP: largest over exposures (see flip.h).
/// Not-finite terms are skipped and counted in `skipped` (may be null); for FLIP not-finite values count as 0.
/// `errorImage` (may be null) gets the terms: the channels of the images, or the channel Y for FLIP.
double ImageError(const Image &image, const Image &reference, Metric metric, Image *errorImage = nullptr,
                  size_t *skipped = nullptr);

/// `metric` (RelL2 or RelL2Abs) without the worst pixels: the ceil(fraction x pixels) pixels with the largest terms are
/// left out. A pixel's term is the mean over its channels; not-finite ones are skipped first.
double TrimmedRelL2(const Image &image, const Image &reference, double fraction = 0.001, size_t *skipped = nullptr,
                    Metric metric = Metric::RelL2);

}  // namespace pbrt
