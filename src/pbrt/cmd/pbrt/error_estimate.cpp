#include "pbrt/cmd/pbrt/error_estimate.h"

#include <cmath>

namespace pbrt {

namespace {

/// Mean over pixels and channels of (a - b)^2 / (b^2 + 0.01), without values that are not finite.
double RelativeDifference(const Image &a, const Image &b) {
    const auto *x = static_cast<const float *>(a.Data()), *y = static_cast<const float *>(b.Data());
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < b.ValueCount(); ++i) {
        const double value = double(y[i]), difference = double(x[i]) - value;
        const double term = difference * difference / (value * value + 0.01);
        if (!std::isfinite(term)) continue;
        sum += term;
        ++count;
    }
    return count ? sum / static_cast<double>(count) : 0;
}

}  // namespace

void ErrorEstimate::Add(std::shared_ptr<const LivePicture> picture) {
    if (!picture || picture->samples < 1 || (last_ && picture->samples <= last_->samples)) return;
    const double n2 = picture->samples;
    // With few further samples the estimate is rough: the picture before is a better base then.
    if (last_ && (!base_ || 4 * last_->samples <= 3 * picture->samples)) base_ = last_;
    if (base_) {
        const double n1 = base_->samples;
        relL2_ = RelativeDifference(base_->colors, picture->colors) * n1 / (n2 - n1);
    }
    last_ = std::move(picture);
}

}  // namespace pbrt
