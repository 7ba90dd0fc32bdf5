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

/// All ray queries, through Embree. Shapes are traced where they lie (rendering space) or, grouped into objects,
/// through instances. A surface with an alpha texture is hit with probability alpha, by a hash of the ray that is the
/// same for every thread and query order.
class Accel {
  public:
    struct Options {
        /// Embree's robust traversal: rays cannot slip between triangles that share an edge. (Embree's high build
        /// quality is not offered, because robust scenes are built the same either way.)
        bool robust = true;
    };
    Accel() : Accel(Options{}) {}
    explicit Accel(const Options &options);
    ~Accel();
    Accel(const Accel &) = delete;
    Accel &operator=(const Accel &) = delete;

    /// Occluded will not be stopped by this shape, Intersect will. To be called before the shape is added.
    /// `collect`: Occluded reports where the ray passes the shape.
    void LetShadowRaysThrough(ShapeId id, bool collect = false);
    /// To be called before Commit. `alpha` may be null. Shapes and textures must outlive the Accel.
    void AddShape(ShapeId id, const Shape &shape, const FloatTexture *alpha);
    /// Shapes of an object definition; returns its index. `renderFromObject` places the definition itself, where its
    /// alpha textures are evaluated for all instances.
    int AddObject(const std::vector<ShapeId> &ids, const std::vector<const Shape *> &shapes,
                  const std::vector<const FloatTexture *> &alphas, const Transform &renderFromObject = {});
    /// Returns the instance index reported in AccelHit.
    int AddInstance(int object, const Transform &renderFromObject);
    /// An instance that moves, placed by the product of both transforms. All moving instances have the same start and
    /// end time.
    int AddMovingInstance(int object, const AnimatedTransform &renderFromOuter,
                          const AnimatedTransform &outerFromObject = {});
    /// Throws UserError if memory is short, or if an instance is so small that rays from the other end of the scene
    /// have no finite coordinates in its space.
    void Commit();

    /// Bounds of the scene over the whole time of its motion.
    Bounds3 Bounds() const;
    /// The nearest hit with tMin < t < ray.tMax. Empty if Embree cannot trace the ray: with not-a-number, or too far
    /// away.
    std::optional<AccelHit> Intersect(const Ray &ray, Float tMin = 0) const;
    /// True if anything lies strictly inside (0, ray.tMax), or if Embree cannot trace the ray.
    /// `passed`, if not null, must be empty; unless the ray is blocked, it receives the hits that Intersect would find
    /// on shapes that let shadow rays through with `collect`.
    bool Occluded(const Ray &ray, PassedHits *passed = nullptr) const;
    /// The transform of the instance at a time, as rays of that time meet it.
    Transform InstanceTransform(int instance, Float time) const;
    size_t Bytes() const;  ///< as counted by Embree's memory monitor

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// An instance is so small that rays from the other end of the scene have no finite coordinates in its space. Has no
/// location: Accel does not know where instances stand in scene files.
class ReachError : public UserError {
  public:
    using UserError::UserError;
};

}  // namespace pbrt
