#pragma once
#include <memory>
#include <span>
#include <vector>

#include "pbrt/core/ids.h"
#include "pbrt/lights/light.h"
#include "pbrt/lights/light_groups.h"

namespace pbrt {

/// All lights of a scene, in file order. A LightId stands for one part of a light: the parts of all lights are numbered
/// through, those of one light one after the other.
class LightTable {
  public:
    LightTable() = default;
    LightTable(const LightTable &) = delete;  // groups refer to their table
    LightTable &operator=(const LightTable &) = delete;

    /// The id of the light's first part.
    LightId Add(std::unique_ptr<Light> light);
    /// Gives every light the scene's bounding sphere and makes the groups. Once.
    void Finish(const Point3 &sceneCenter, Float sceneRadius);

    /// Parts of all lights.
    size_t Size() const { return wholeOf_.size(); }
    LightPart operator[](LightId id) const {
        const Whole &whole = wholes_[wholeOf_[id.value]];
        return {*whole.light, id.value - whole.first};
    }
    size_t WholeCount() const { return wholes_.size(); }
    /// Which of the lights it is a part of; below WholeCount().
    uint32_t WholeOf(LightId id) const { return wholeOf_[id.value]; }

    /// What a ray meets that leaves the scene from o in direction d: calls visit(radiance, id) for every infinite light
    /// that shines there, with the part that is met.
    template <class Visit>
    void ForEachBeyond(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda, Visit &&visit) const {
        for (LightId first : infinite_) {
            const Light &light = (*this)[first].Whole();
            if (SampledSpectrum Le = light.Le(o, d, lambda)) visit(Le, LightId(first.value + light.PartTowards(d)));
        }
    }
    bool HasInfinite() const { return !infinite_.empty(); }
    /// Lights whose power is beyond single precision; to choose from they have none.
    std::span<const LightId> Overflowed() const { return overflowed_; }
    /// What light samplers choose from; needs Finish.
    LightCandidate Candidate(LightId id) const;
    /// Every part on its own, or every light with all its parts.
    const LightGroups &Parts() const { return *parts_; }
    const LightGroups &Wholes() const { return *groupsOfWholes_; }

  private:
    struct Whole {
        std::unique_ptr<Light> light;
        uint32_t first = 0;  ///< its first part
    };
    std::vector<Whole> wholes_;
    std::vector<uint32_t> wholeOf_;  ///< per part
    std::vector<Float> power_;       ///< per part, as in LightCandidate
    std::vector<LightId> infinite_;  ///< the first parts of infinite lights
    std::vector<LightId> overflowed_;
    std::unique_ptr<LightGroups> parts_, groupsOfWholes_;
};

}  // namespace pbrt
