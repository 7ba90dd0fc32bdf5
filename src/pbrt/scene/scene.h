#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "pbrt/accel/accel.h"
#include "pbrt/cameras/camera.h"
#include "pbrt/lights/light_table.h"
#include "pbrt/materials/material.h"
#include "pbrt/media/medium.h"

namespace pbrt {

/// A shape with the properties beyond its geometry.
struct ShapeRecord {
    std::unique_ptr<Shape> shape;
    FloatTexturePtr alpha;  ///< null: opaque
    MaterialId material{};
    LightId firstLight{};  ///< light of primitive 0; the others follow
    MediumId insideMedium{}, outsideMedium{};
};

/// Everything that build/ hands over to a Scene.
struct SceneContents {
    std::vector<ShapeRecord> shapes;
    std::vector<MaterialPtr> materials;
    std::unique_ptr<Accel> accel;
    std::unique_ptr<LightTable> lights;
    std::vector<std::unique_ptr<Medium>> media;
    MediumId cameraMedium{};  ///< the medium that the camera stands in
    /// The media that a light stands in, by LightTable::LightOf. The inside is that behind the shape of an area light;
    /// for other lights both are the same, and vacuum for those beyond the scene.
    struct LightMedia {
        MediumId outside{}, inside{};
    };
    std::vector<LightMedia> lightMedia{};
};

/// The immutable scene: ray queries, lights, materials by id. No setters.
class Scene {
  public:
    explicit Scene(SceneContents contents);

    /// Nearest surface along the ray, complete but for the filter footprint.
    std::optional<SurfacePoint> Intersect(const Ray &ray) const;
    /// The same, written to *point; false if the ray hits nothing.
    bool Intersect(const Ray &ray, SurfacePoint *point) const;
    /// One of the points where a segment crosses surfaces of shapes with a material, all equally likely.
    struct Crossing {
        SurfacePoint point;
        int count = 1;  ///< number of crossings it was drawn from
    };
    std::optional<Crossing> SampleCrossing(const Point3 &from, const Point3 &to, Float time, MaterialId material,
                                           Float u) const;
    /// True if a surface lies between the points. Both ends are moved off their surfaces first.
    bool Occluded(const LightSampleContext &from, const LightLiSample &to) const {
        return Occluded(ShadowRay(from, to));
    }
    bool Occluded(const Ray &ray) const { return Occluded(ray, nullptr); }
    /// The segment between both points as a ray to its end, which is moved off the light's surface by the error bound
    /// of the sample and of the intersection; its direction has no unit length.
    static Ray ShadowRay(const LightSampleContext &from, const LightLiSample &to);
    /// A surface between media on a ray, and the medium behind it.
    struct Interface {
        Float t = 0;
        MediumId behind{};
    };
    /// Like Occluded; if the ray is not blocked, `passed` receives the surfaces between media that it passes.
    bool Occluded(const Ray &ray, PassedHits *passed) const;
    Interface InterfaceAt(const AccelHit &passed, const Ray &ray) const {
        return {passed.hit.t, SurfaceAt(passed, ray).MediumTowards(ray.d)};
    }
    /// The first such surface behind `tMin` that shadow rays pass, for rays that pass more of them than PassedHits
    /// holds.
    std::optional<Interface> NextInterface(const Ray &ray, Float tMin) const;

    const LightTable &Lights() const { return *contents_.lights; }
    const Material &MaterialOf(MaterialId id) const { return *contents_.materials[id.value]; }
    /// Null: vacuum.
    const Medium *MediumAt(MediumId id) const { return id ? contents_.media[id.value].get() : nullptr; }
    /// True if some ray can be in a medium.
    bool HasMedia() const { return hasMedia_; }
    /// The medium in which camera rays start.
    MediumId CameraMedium() const { return contents_.cameraMedium; }
    /// The medium in which light leaves a light in direction w, from a surface of this normal (zero: from none).
    MediumId MediumOfLight(LightId id, const Normal3 &n, const Vector3 &w) const;
    const Shape &ShapeOf(ShapeId id) const { return *contents_.shapes[id.value].shape; }
    size_t ShapeCount() const { return contents_.shapes.size(); }
    /// True if some material scatters light below its surface.
    bool HasSubsurface() const { return hasSubsurface_; }
    /// True if some material uses filter footprints.
    bool NeedsFootprints() const { return needsFootprints_; }
    bool NeedsFootprintAt(const SurfacePoint &point) const {
        return point.material && contents_.materials[point.material.value] &&
               contents_.materials[point.material.value]->NeedsFootprint();
    }
    const Bounds3 &Bounds() const { return bounds_; }
    const Accel &Acceleration() const { return *contents_.accel; }

  private:
    SurfacePoint SurfaceAt(const AccelHit &hit, const Ray &ray) const;
    /// The point of a shape of an object, placed by the instance that was hit.
    SurfacePoint InstancedSurface(const Shape &shape, const AccelHit &hit, const Ray &ray) const;
    SceneContents contents_;
    Bounds3 bounds_;
    bool hasSubsurface_ = false, needsFootprints_ = false, hasMedia_ = false;
};

}  // namespace pbrt
