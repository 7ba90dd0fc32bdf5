#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "pbrt/core/float.h"

namespace pbrt {

/// First selection of samplers with light bounds, as in stock pbrt-v4: every infinite light, and all bounded lights
/// together, have equal probability.
class InfiniteShare {
  public:
    InfiniteShare() = default;
    InfiniteShare(std::vector<uint32_t> infinite, bool anyBounded)
        : infinite_(std::move(infinite)), anyBounded_(anyBounded) {
        size_t shares = infinite_.size() + (anyBounded ? 1 : 0);
        share_ = shares > 0 ? 1 / Float(shares) : 0;
        boundedFrom_ = double(infinite_.size()) / double(std::max<size_t>(shares, 1));
    }
    /// Probability of each infinite light, and of all bounded ones together.
    Float Pmf() const { return share_; }
    /// Returns true for the bounded lights, remapping `u` to a fresh number; else sets `chosen`. There must be a light
    /// of either kind.
    bool ChooseBounded(double &u, uint32_t *chosen) const {
        if (anyBounded_ && u >= boundedFrom_) {
            u = (u - boundedFrom_) / (1 - boundedFrom_);
            return true;
        }
        double scaled = u / boundedFrom_ * double(infinite_.size());
        *chosen = infinite_[std::min(size_t(scaled), infinite_.size() - 1)];
        return false;
    }
    size_t Bytes() const { return infinite_.capacity() * sizeof(uint32_t); }

  private:
    std::vector<uint32_t> infinite_;
    bool anyBounded_ = false;
    Float share_ = 0;
    double boundedFrom_ = 0;
};

}  // namespace pbrt
