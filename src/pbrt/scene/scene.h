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

struct ShapeRecord {
    std::unique_ptr<Shape> shape;
    FloatTexturePtr alpha;  ///< null: opaque
    MaterialId material{};
    LightId firstLight{};  ///< light of primitive 0; the others follow
    MediumId insideMedium{}, outsideMedium{};
};

struct SceneContents {
    std::vector<ShapeRecord> shapes;
    std::vector<MaterialPtr> materials;
    std::unique_ptr<Accel> accel;
    std::unique_ptr<LightTable> lights;
    std::vector<std::unique_ptr<Medium>> media;
    MediumId cameraMedium{};  ///< medium of the camera
    /// Media around a light, by LightTable::LightOf. `inside` is behind the shape of an area light; for other lights
    /// both are equal, and vacuum for infinite and distant ones.
    struct LightMedia {
        MediumId outside{}, inside{};
    };
    std::vector<LightMedia> lightMedia{};
    Point3 worldOrigin{};  ///< in rendering space
};

/// Immutable scene: ray queries, lights, materials by id.
class Scene {
  public:
    explicit Scene(SceneContents contents);

    /// Nearest surface along the ray, complete except for the filter footprint.
    std::optional<SurfacePoint> Intersect(const Ray &ray) const;
    bool Intersect(const Ray &ray, SurfacePoint *point) const;
    /// As Intersect for rays from the camera. A plane through the camera is edge-on: not seen, although rounding may
    /// move it in front of the ray's origin.
    bool IntersectFromCamera(const Ray &ray, SurfacePoint *point) const;
    /// A uniformly chosen crossing of a segment with surfaces that have a material.
    struct Crossing {
        SurfacePoint point;
        int count = 1;  ///< number of candidate crossings
    };
    std::optional<Crossing> SampleCrossing(const Point3 &from, const Point3 &to, Float time, MaterialId material,
                                           Float u) const;
    /// True if a surface lies between the points, both offset from their surfaces.
    bool Occluded(const LightSampleContext &from, const LightLiSample &to) const {
        return Occluded(ShadowRay(from, to));
    }
    bool Occluded(const Ray &ray) const { return Occluded(ray, nullptr); }
    /// Unnormalised shadow ray between both points, ending before the light's surface by the error bounds of sample and
    /// intersection.
    static Ray ShadowRay(const LightSampleContext &from, const LightLiSample &to);
    struct Interface {
        Float t = 0;
        MediumId behind{};
    };
    /// As Occluded; if unblocked, `passed` receives the interfaces between media.
    bool Occluded(const Ray &ray, PassedHits *passed) const;
    Interface InterfaceAt(const AccelHit &passed, const Ray &ray) const {
        return {passed.hit.t, SurfaceAt(passed, ray).MediumTowards(ray.d)};
    }
    /// First such interface beyond `tMin`, for rays with more of them than PassedHits holds.
    std::optional<Interface> NextInterface(const Ray &ray, Float tMin) const;

    const LightTable &Lights() const { return *contents_.lights; }
    const Material &MaterialOf(MaterialId id) const { return *contents_.materials[id.value]; }
    /// Null: vacuum.
    const Medium *MediumAt(MediumId id) const { return id ? contents_.media[id.value].get() : nullptr; }
    /// True if any ray can be in a medium.
    bool HasMedia() const { return hasMedia_; }
    MediumId CameraMedium() const { return contents_.cameraMedium; }
    /// Medium into which light leaves in direction w, from a surface of normal n (zero: no surface).
    MediumId MediumOfLight(LightId id, const Normal3 &n, const Vector3 &w) const;
    const Shape &ShapeOf(ShapeId id) const { return *contents_.shapes[id.value].shape; }
    size_t ShapeCount() const { return contents_.shapes.size(); }
    /// True if a material has subsurface scattering.
    bool HasSubsurface() const { return hasSubsurface_; }
    /// True if a material uses filter footprints.
    bool NeedsFootprints() const { return needsFootprints_; }
    bool NeedsFootprintAt(const SurfacePoint &point) const {
        return point.material && contents_.materials[point.material.value] &&
               contents_.materials[point.material.value]->NeedsFootprint();
    }
    const Bounds3 &Bounds() const { return bounds_; }
    const Accel &Acceleration() const { return *contents_.accel; }

  private:
    SurfacePoint SurfaceAt(const AccelHit &hit, const Ray &ray) const;
    /// True if the hit is on a flat primitive whose plane, but for rounding, passes through the ray's origin.
    bool StartsInPlane(const AccelHit &hit, const Ray &ray) const;
    SurfacePoint InstancedSurface(const Shape &shape, const AccelHit &hit, const Ray &ray) const;
    SceneContents contents_;
    Bounds3 bounds_;
    Float maxRounding_ = 0;  ///< no plane is moved farther by StartsInPlane's rounding
    bool hasSubsurface_ = false, needsFootprints_ = false, hasMedia_ = false;
};

}  // namespace pbrt
