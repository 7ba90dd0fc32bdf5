#pragma once
#include <memory>
#include <optional>
#include <string>

#include "pbrt/cmd/pbrt/live_board.h"

namespace pbrt {

/// Estimates the error of a picture that grows, without a reference, from what its last samples changed.
///
/// M1 is the mean of a pixel's first n1 samples, M2 that of n2 > n1 samples. If samples are independent with variance
/// v, then M2 - M1 has the variance v (1/n1 - 1/n2), and M2 the variance v/n2, that is (M2 - M1)^2 n1 / (n2 - n1) on
/// average. The mean of that over pixels and channels, each divided by M2^2 + RelL2Epsilon, estimates the relL2 that
/// imgtool diff measures. Samples of a low-discrepancy sampler are spread better than independent ones: they change
/// less, but what they will still change is less, too.
class ErrorEstimate {
  public:
    /// To be called for the pictures in order; some may be left out.
    void Add(std::shared_ptr<const LivePicture> picture);
    /// relL2 of the last picture; empty while there is nothing to compare with.
    std::optional<double> RelL2() const { return relL2_; }
    /// Why there is no estimate, for people; empty if there is one. `isFinal`: no picture follows.
    std::string WhyNone(bool isFinal) const;

  private:
    std::shared_ptr<const LivePicture> base_, last_;
    std::optional<double> relL2_;
};

}  // namespace pbrt
