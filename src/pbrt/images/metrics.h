#pragma once
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "pbrt/images/image.h"

namespace pbrt {

/// Image error measures over all pixels and channels; both FLIPs are per pixel and need R, G and B.
enum class Metric { MAE, MSE, MRSE, RelL2, RelL2Abs, SMAPE, FLIP, HdrFLIP };
/// Names in the order of Metric.
inline const std::vector<std::string> &MetricNames() {
    static const std::vector<std::string> names = {"MAE",      "MSE",   "MRSE", "relL2",
                                                   "relL2Abs", "SMAPE", "FLIP", "HDR-FLIP"};
    return names;
}
/// Metric of this name, one of MetricNames; empty for another.
inline std::optional<Metric> ParseMetric(const std::string &name) {
    for (size_t i = 0; i < MetricNames().size(); ++i)
        if (MetricNames()[i] == name) return static_cast<Metric>(i);
    return {};
}

/// Epsilon of relL2 for a reference of mean magnitude `mean`: 0.01 mean^2, which makes relL2 independent of exposure;
/// 0.01 for a black reference.
double RelL2Epsilon(double mean);
/// For the mean magnitude of the finite values of R, G, B, or of all channels if one of these is missing.
double RelL2Epsilon(const Image &reference);

/// Indices of R, G and B; of all channels if one of these is missing.
inline std::vector<int> RgbOrAllChannels(const Image &image) {
    if (image.HasRgb()) return {image.FindChannel("R"), image.FindChannel("G"), image.FindChannel("B")};
    std::vector<int> channels(image.ChannelCount());
    std::iota(channels.begin(), channels.end(), 0);
    return channels;
}

/// Mean of the finite values among those added; 0 if there are none.
struct FiniteMean {
    double sum = 0;
    size_t count = 0, skipped = 0;
    void Add(double v) {
        if (std::isfinite(v)) sum += v;
        ++(std::isfinite(v) ? count : skipped);
    }
    void operator+=(const FiniteMean &o) {
        sum += o.sum;
        count += o.count;
        skipped += o.skipped;
    }
    double Mean() const { return count ? sum / double(count) : 0; }
};

/// MAE: mean |x-r|. MSE: mean (x-r)^2. MRSE: mean (x-r)^2/(r+0.01)^2, as in pbrt-v4. RelL2: mean (x-r)^2/(r^2+epsilon),
/// see RelL2Epsilon. RelL2Abs (the paper's tables, depends on exposure): mean (x-r)^2/(r^2+0.01). SMAPE: mean
/// |x-r|/((|x|+|r|)/2 + 0.01), between 0 and 2. FLIP: values clamped to [0, 1], as in stock pbrt-v4. HdrFLIP: maximum
/// over exposures (see FlipReference). Non-finite terms are skipped and counted in `skipped` (may be null); for FLIP
/// non-finite values count as 0. `errorImage` (may be null) gets the terms: the images' channels, or Y for FLIP.
double ImageError(const Image &image, const Image &reference, Metric metric, Image *errorImage = nullptr,
                  size_t *skipped = nullptr);

/// Trimmed RelL2 or RelL2Abs: omits the ceil(fraction x pixels) pixels with the largest terms. A pixel's term is the
/// mean over its channels; non-finite ones are skipped first.
double TrimmedRelL2(const Image &image, const Image &reference, double fraction = 0.001, Metric metric = Metric::RelL2);

/// FLIP: perceived difference, in [0, 1] per pixel, of two images when alternating between them. Andersson et al. 2020,
/// "FLIP: A Difference Evaluator for Alternating Images" (LDR); Andersson, Nilsson, Shirley, Akenine-Moller 2021,
/// "Visualizing Errors in Rendered High Dynamic Range Images" (HDR). HDR is the largest LDR value over exposures that
/// map the maximum to those that map the median. R, G, B are linear sRGB; non-finite values count as 0; images extend
/// with the nearest pixel.
///
/// Preprocessed reference for any number of comparisons. Thread-safe; results are independent of the thread count.
class FlipReference {
  public:
    /// `isHdr` false: values clamped to [0, 1]. true: exposures from the reference, ACES tone curve. Throws UserError
    /// if channel R, G or B is missing.
    explicit FlipReference(const Image &reference, bool isHdr = false);
    /// Mean over all pixels. `errorImage` (may be null) gets channel Y. Throws UserError if the resolution differs or a
    /// channel is missing.
    double Compare(const Image &image, Image *errorImage = nullptr) const;
    /// log2 of the exposure factors, at most 16; empty unless HDR.
    const std::vector<double> &Exposures() const { return exposures_; }

  private:
    /// Perceptual representation of one exposure, as planes of pixels.
    struct Percept {
        std::vector<float> l, a, b;      ///< filtered, CIELAB with Hunt's adjustment
        std::vector<float> edge, point;  ///< norms of the first and second derivative of the lightness
    };
    /// Linear planes in the order R, G, B.
    static std::vector<float> Planes(const Image &image);
    Percept Perceive(const std::vector<float> &planes, size_t exposure) const;
    float Difference(const Percept &reference, const Percept &test, size_t pixel) const;

    Point2i resolution_{0, 0};
    std::vector<double> exposures_;
    std::vector<Percept> percepts_;  ///< of the reference; one per exposure, or one
    double largestColorDifference_ = 0;
};

}  // namespace pbrt
