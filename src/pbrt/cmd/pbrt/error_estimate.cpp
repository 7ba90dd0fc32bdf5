#include "pbrt/cmd/pbrt/live_board.h"

#include <cmath>

#include "pbrt/images/metrics.h"

namespace pbrt {

void ErrorEstimate::Add(std::shared_ptr<const LivePicture> picture) {
    if (!picture || picture->samples < 1 || (last_ && picture->samples <= last_->samples)) return;
    const double n2 = picture->samples;
    // With few additional samples the estimate is rough; the previous base is better then.
    if (last_ && (!base_ || 4 * last_->samples <= 3 * picture->samples)) base_ = last_;
    if (base_) {
        const double n1 = base_->samples;
        relL2_ = ImageError(base_->colors, picture->colors, Metric::RelL2) * n1 / (n2 - n1);
    }
    last_ = std::move(picture);
}

std::string ErrorEstimate::WhyNone(bool isFinal) const {
    if (!last_) return isFinal ? "no picture was made" : "no samples yet";
    if (!base_)
        return isFinal ? "an estimate needs two pictures; the render had only one"
                       : "an estimate needs two pictures; this is the first";
    return std::isfinite(*relL2_) ? "" : "some pixels are not finite";
}

}  // namespace pbrt
