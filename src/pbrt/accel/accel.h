#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "pbrt/core/ids.h"
#include "pbrt/math/animated_transform.h"
#include "pbrt/shapes/shape.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// What the accelerator reports: which primitive, where on it, and in which instance.
struct AccelHit {
    ShapeId shape{};
    uint32_t primitive = 0;
    PrimitiveHit hit{};
    int32_t instance = -1;  ///< -1: placed directly in the scene
};

/// All ray queries, through Embree. Shapes are traced where they lie (rendering space) or, grouped into objects,
/// through instances. A surface with an alpha texture is hit with probability alpha, by a hash of the ray that is the
/// same for every thread and query order.
class Accel {
  public:
    struct Options {
        /// Embree's robust traversal: rays cannot slip between triangles that share an edge. (Embree's high build
        /// quality is no option beside it: robust scenes are built the same either way.)
        bool robust = true;
    };
    Accel() : Accel(Options{}) {}
    explicit Accel(const Options &options);
    ~Accel();
    Accel(const Accel &) = delete;
    Accel &operator=(const Accel &) = delete;

    /// Before the shape is added: Occluded will not see it, Intersect will.
    void LetShadowRaysThrough(ShapeId id);
    /// Before Commit. `alpha` may be null. Shapes and textures must outlive the Accel.
    void AddShape(ShapeId id, const Shape &shape, const FloatTexture *alpha);
    /// Shapes of an object definition; returns its index.
    int AddObject(const std::vector<ShapeId> &ids, const std::vector<const Shape *> &shapes,
                  const std::vector<const FloatTexture *> &alphas);
    /// Returns the instance index reported in AccelHit.
    int AddInstance(int object, const Transform &renderFromObject);
    /// One that moves, placed by the product of both. All that move do so in the same interval of time.
    int AddMovingInstance(int object, const AnimatedTransform &renderFromOuter,
                          const AnimatedTransform &outerFromObject = {});
    /// Throws UserError if memory is short, or if an instance is so small that rays from the other end of the scene
    /// have no finite coordinates in its space.
    void Commit();

    /// Of all that moves: over the whole time.
    Bounds3 Bounds() const;
    /// The nearest hit with tMin < t < ray.tMax. None for rays that are none: not-a-number, or too far away for Embree.
    std::optional<AccelHit> Intersect(const Ray &ray, Float tMin = 0) const;
    /// True if anything lies strictly inside (0, ray.tMax), or if the ray is none.
    bool Occluded(const Ray &ray) const;
    /// The transform of the instance at a time, as rays of that time meet it.
    Transform InstanceTransform(int instance, Float time) const;
    size_t Bytes() const;  ///< as counted by Embree's memory monitor

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace pbrt
