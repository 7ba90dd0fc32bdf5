#pragma once
#include <string>
#include <vector>

#include "pbrt/images/image.h"

namespace pbrt {

/// Image error measures over all pixels and channels; both FLIPs are per pixel and need R, G and B.
enum class Metric { MAE, MSE, MRSE, RelL2, RelL2Abs, SMAPE, FLIP, HdrFLIP };
std::optional<Metric> ParseMetric(const std::string &name);
const std::vector<std::string> &MetricNames();

/// Epsilon of relL2 for a reference of mean magnitude `mean`: 0.01 mean^2, which makes relL2 independent of exposure;
/// 0.01 for a black reference.
double RelL2Epsilon(double mean);
/// For the mean magnitude of the finite values of R, G, B, or of all channels if one of these is missing.
double RelL2Epsilon(const Image &reference);

/// MAE: mean |x-r|. MSE: mean (x-r)^2. MRSE: mean (x-r)^2/(r+0.01)^2, as in pbrt-v4. RelL2: mean (x-r)^2/(r^2+epsilon),
/// see RelL2Epsilon. RelL2Abs (the paper's tables, depends on exposure): mean (x-r)^2/(r^2+0.01). SMAPE: mean
/// |x-r|/((|x|+|r|)/2 + 0.01), between 0 and 2. FLIP: values clamped to [0, 1], as in stock pbrt-v4. HdrFLIP: maximum
/// over exposures (see flip.h). Non-finite terms are skipped and counted in `skipped` (may be null); for FLIP
/// non-finite values count as 0. `errorImage` (may be null) gets the terms: the images' channels, or Y for FLIP.
double ImageError(const Image &image, const Image &reference, Metric metric, Image *errorImage = nullptr,
                  size_t *skipped = nullptr);

/// Trimmed RelL2 or RelL2Abs: omits the ceil(fraction x pixels) pixels with the largest terms. A pixel's term is the
/// mean over its channels; non-finite ones are skipped first.
double TrimmedRelL2(const Image &image, const Image &reference, double fraction = 0.001, size_t *skipped = nullptr,
                    Metric metric = Metric::RelL2);

}  // namespace pbrt
