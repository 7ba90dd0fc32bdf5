#pragma once
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/math/animated_transform.h"
#include "pbrt/shapes/shape.h"
#include "pbrt/textures/texture.h"

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
        while (i > 0 && hit.hit.t < hits_[i - 1].hit.t) --i;
        if (i > 0 && hits_[i - 1].hit.t == hit.hit.t) {
            AccelHit &kept = hits_[i - 1];
            if (Identity(hit) < Identity(kept)) kept = hit;
            return;
        }
        if (count_ == kMaxHits) {
            hasDropped_ = true;
            if (i == kMaxHits) return;
            --count_;
        }
        std::copy_backward(hits_.begin() + i, hits_.begin() + count_, hits_.begin() + count_ + 1);
        hits_[i] = hit;
        ++count_;
    }
    std::span<AccelHit> Hits() { return std::span(hits_).first(count_); }
    std::span<const AccelHit> Hits() const { return std::span(hits_).first(count_); }
    bool HasDropped() const { return hasDropped_; }

  private:
    static std::array<uint32_t, 3> Identity(const AccelHit &hit) {
        return {hit.shape.value, hit.primitive, uint32_t(hit.instance)};
    }
    std::array<AccelHit, kMaxHits> hits_;
    int count_ = 0;
    bool hasDropped_ = false;
};

/// Ray queries through Embree. Shapes are in rendering space or, grouped into objects, instanced. Surfaces with an
/// alpha texture are hit with probability alpha, by a hash of the ray that is independent of thread and query order.
class Accel {
  public:
    /// `robust`: Embree's robust traversal, watertight at shared edges.
    explicit Accel(bool robust = true);
    ~Accel();
    Accel(const Accel &) = delete;
    Accel &operator=(const Accel &) = delete;

    /// Makes Occluded ignore this shape, unlike Intersect. To be called before the shape is added. `collect`: Occluded
    /// reports its hits.
    void LetShadowRaysThrough(ShapeId id, bool collect = false);
    /// To be called before Commit. `alpha` may be null. Shapes and textures must outlive the Accel.
    void AddShape(ShapeId id, const Shape &shape, const FloatTexture *alpha);
    /// Adds an object definition; returns its index. `renderFromObject` places the definition itself, where its alpha
    /// textures are evaluated for all instances.
    int AddObject(const std::vector<ShapeId> &ids, const std::vector<const Shape *> &shapes,
                  const std::vector<const FloatTexture *> &alphas, const Transform &renderFromObject = {});
    int AddInstance(int object, const Transform &renderFromObject);
    /// A moving instance, placed by the product of both transforms. All moving instances share start and end time.
    int AddMovingInstance(int object, const AnimatedTransform &renderFromOuter,
                          const AnimatedTransform &outerFromObject = {});
    /// Throws UserError if memory is short, or ReachError.
    void Commit();

    /// Bounds over the whole motion.
    Bounds3 Bounds() const;
    /// Nearest hit with tMin < t < ray.tMax. Empty for rays that Embree cannot trace: NaN, or too far away.
    std::optional<AccelHit> Intersect(const Ray &ray, Float tMin = 0) const;
    /// True if a surface lies strictly inside (0, ray.tMax), or if Embree cannot trace the ray. `passed`, if not null,
    /// must be empty; unless the ray is blocked, it receives the hits on shapes passed with `collect`.
    bool Occluded(const Ray &ray, PassedHits *passed = nullptr) const;
    Transform InstanceTransform(int instance, Float time) const;
    size_t Bytes() const;  ///< as counted by Embree's memory monitor

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// An instance is so small that rays from the far end of the scene overflow in its space. No location: Accel has no
/// scene-file locations.
class ReachError : public UserError {
  public:
    using UserError::UserError;
};

}  // namespace pbrt
