#pragma once
#include <algorithm>
#include <array>
#include <span>

#include "pbrt/core/ids.h"
#include "pbrt/shapes/shape.h"

namespace pbrt {

struct AccelHit {
    ShapeId shape{};
    uint32_t primitive = 0;
    PrimitiveHit hit{};
    int32_t instance = -1;  ///< -1: placed directly in the scene
};

/// Fixed-size list of the nearest surfaces passed by a shadow ray, in ray order. Hits at equal distance are kept once,
/// because rays through a shared edge hit both triangles and primitives in several boxes are reported repeatedly.
class PassedHits {
  public:
    static constexpr int kMaxHits = 8;

    /// The result is independent of the order of additions.
    void Add(const AccelHit &hit) {
        int i = count_;
        while (i > 0 && hit.hit.t < hits_[At(i - 1)].hit.t) --i;
        if (i > 0 && hits_[At(i - 1)].hit.t == hit.hit.t) {
            AccelHit &kept = hits_[At(i - 1)];
            if (Identity(hit) < Identity(kept)) kept = hit;
            return;
        }
        if (count_ == kMaxHits) {
            hasDropped_ = true;
            if (i == kMaxHits) return;
            --count_;
        }
        std::copy_backward(hits_.begin() + i, hits_.begin() + count_, hits_.begin() + count_ + 1);
        hits_[At(i)] = hit;
        ++count_;
    }
    std::span<AccelHit> Hits() { return {hits_.data(), At(count_)}; }
    std::span<const AccelHit> Hits() const { return {hits_.data(), At(count_)}; }
    bool HasDropped() const { return hasDropped_; }

  private:
    static size_t At(int i) { return static_cast<size_t>(i); }
    static std::array<uint32_t, 3> Identity(const AccelHit &hit) {
        return {hit.shape.value, hit.primitive, static_cast<uint32_t>(hit.instance)};
    }
    std::array<AccelHit, kMaxHits> hits_;
    int count_ = 0;
    bool hasDropped_ = false;
};

}  // namespace pbrt
