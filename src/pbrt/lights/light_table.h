#pragma once
#include <memory>
#include <span>
#include <vector>

#include "pbrt/core/ids.h"
#include "pbrt/lights/light.h"
#include "pbrt/lights/light_groups.h"

namespace pbrt {

/// All lights of a scene in file order. A LightId identifies one component; the components of a light have consecutive
/// ids.
class LightTable {
  public:
    LightTable() = default;
    LightTable(const LightTable &) = delete;  // groups refer to their table
    LightTable &operator=(const LightTable &) = delete;

    /// Appends a light and returns the id of its first component. Not after Finish.
    LightId Add(std::unique_ptr<Light> light);
    /// Sets every light's scene bounding sphere and builds the groups. Call once, after the last Add.
    void Finish(const Point3 &sceneCenter, Float sceneRadius);

    /// Number of components of all lights.
    size_t Size() const { return lightOf_.size(); }
    LightComponent operator[](LightId id) const { return Region(id, {}); }
    /// Region of an environment light; other lights have none.
    LightComponent Region(LightId id, EnvironmentRegion region) const {
        const Entry &entry = lights_[lightOf_[id.value]];
        return {*entry.light, id.value - entry.first, region};
    }
    size_t LightCount() const { return lights_.size(); }
    /// Index of the component's light, below LightCount().
    uint32_t LightOf(LightId id) const { return lightOf_[id.value]; }

    /// Environment lights without Opening, in file order.
    std::span<const LightId> Environments() const { return environments_; }

    /// For a ray from o in direction d that leaves the scene: calls visit(radiance, id) for every infinite light with
    /// nonzero radiance, with the id of the whole light.
    template <class Visit>
    void ForEachBeyond(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda, Visit &&visit) const {
        for (LightId first : infinite_) {
            if (SampledSpectrum Le = (*this)[first].Parent().Le(o, d, lambda)) visit(Le, first);
        }
    }
    bool HasInfinite() const { return !infinite_.empty(); }
    /// Power and bounds of a component, for light samplers. Only after Finish.
    LightCandidate Candidate(LightId id) const;
    /// Unit of candidate powers (as Light::Phi): the geometric mean of minimum and maximum component power over the
    /// scene radius. So powers, and powers over squared distances, neither overflow nor underflow in single precision.
    /// A power of two: division by it is exact.
    double Unit() const { return unit_; }
    /// Groups by component, and by light. Only after Finish.
    const LightGroups &ByComponent() const { return *byComponent_; }
    const LightGroups &ByLight() const { return *byLight_; }

  private:
    struct Entry {
        std::unique_ptr<Light> light;
        uint32_t first = 0;
    };
    std::vector<Entry> lights_;
    std::vector<uint32_t> lightOf_;  ///< per component
    std::vector<Float> power_;       ///< per component, as LightCandidate::power
    double unit_ = 1;
    std::vector<LightId> infinite_;  ///< first components of infinite lights
    std::vector<LightId> environments_;
    std::unique_ptr<LightGroups> byComponent_, byLight_;
};

}  // namespace pbrt
