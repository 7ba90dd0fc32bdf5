#pragma once
#include <memory>
#include <span>
#include <vector>

#include "pbrt/core/ids.h"
#include "pbrt/lights/light.h"

namespace pbrt {

/// One thing a light sampler can choose: a light, or a group of lights.
struct LightCandidate {
    Float power = 0;                    ///< Phi averaged over the visible wavelengths, >= 0
    std::optional<LightBounds> bounds;  ///< empty: infinite (or no power)
    bool infinite = false;
};

/// All lights of a scene by dense id, in file order; an emissive mesh contributes one light per primitive, contiguous.
class LightTable {
  public:
    /// `mesh`: for area lights, one id (of its first shape) for all lights of one Shape directive; none otherwise.
    LightId Add(std::unique_ptr<Light> light, ShapeId mesh = {}, uint32_t primitive = 0);
    /// Gives every light the scene's bounding sphere and fills the candidates. Once.
    void Finish(const Point3 &sceneCenter, Float sceneRadius);

    size_t Size() const { return lights_.size(); }
    const Light &operator[](LightId id) const { return *lights_[id.value]; }
    /// The emissive mesh a light is a primitive of; none for other lights.
    ShapeId MeshOf(LightId id) const { return meshes_[id.value]; }
    uint32_t PrimitiveOf(LightId id) const { return primitives_[id.value]; }
    /// Infinite lights, those that rays leaving the scene must ask.
    std::span<const LightId> Infinite() const { return infinite_; }
    /// Lights whose power is beyond single precision; as candidates they have none.
    std::span<const LightId> Overflowed() const { return overflowed_; }
    /// One per light.
    std::span<const LightCandidate> Candidates() const { return candidates_; }

  private:
    std::vector<LightId> overflowed_;
    std::vector<std::unique_ptr<Light>> lights_;
    std::vector<ShapeId> meshes_;
    std::vector<uint32_t> primitives_;
    std::vector<LightId> infinite_;
    std::vector<LightCandidate> candidates_;
};

}  // namespace pbrt
