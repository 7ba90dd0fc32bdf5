#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "pbrt/accel/passed_hits.h"
#include "pbrt/core/error.h"
#include "pbrt/math/animated_transform.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// Ray queries through Embree. Shapes are in rendering space or, grouped into objects, instanced. Surfaces with an
/// alpha texture are hit with probability alpha, by a hash of the ray that is independent of thread and query order.
class Accel {
  public:
    struct Options {
        /// Embree's robust traversal: watertight at shared edges. (High build quality is not offered, because Embree
        /// builds robust scenes the same either way.)
        bool robust = true;
    };
    Accel() : Accel(Options{}) {}
    explicit Accel(const Options &options);
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
