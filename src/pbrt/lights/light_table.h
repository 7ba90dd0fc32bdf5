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

    /// Appends a light and returns the id of its first part. Not after Finish.
    LightId Add(std::unique_ptr<Light> light);
    /// Gives every light the scene's bounding sphere and makes the groups. Must be called once, after the last Add.
    void Finish(const Point3 &sceneCenter, Float sceneRadius);

    /// The number of parts of all lights.
    size_t Size() const { return wholeOf_.size(); }
    LightPart operator[](LightId id) const { return Region(id, {}); }
    /// A region of an environment light. Any other light has no regions.
    LightPart Region(LightId id, EnvironmentRegion region) const {
        const Whole &whole = wholes_[wholeOf_[id.value]];
        return {*whole.light, id.value - whole.first, region};
    }
    size_t WholeCount() const { return wholes_.size(); }
    /// The index of the light that the part belongs to, below WholeCount().
    uint32_t WholeOf(LightId id) const { return wholeOf_[id.value]; }

    /// Environment lights that shine from all sides (EnvironmentLight::Opening is empty), in file order.
    std::span<const LightId> Environments() const { return environments_; }

    /// For a ray from o in direction d that leaves the scene: calls visit(radiance, id) for every infinite light with
    /// radiance along the ray, with the id of the whole light.
    template <class Visit>
    void ForEachBeyond(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda, Visit &&visit) const {
        for (LightId first : infinite_) {
            if (SampledSpectrum Le = (*this)[first].Whole().Le(o, d, lambda)) visit(Le, first);
        }
    }
    bool HasInfinite() const { return !infinite_.empty(); }
    /// What a light sampler knows of a part when it chooses. Only after Finish.
    LightCandidate Candidate(LightId id) const;
    /// The power (as of Light::Phi) that is 1 in candidates. It is the geometric mean of the least and the greatest
    /// power of all parts over the radius of the scene, so that powers of lights, and powers over squared distances,
    /// neither overflow nor underflow in single precision. A power of two: dividing by it is exact.
    double Unit() const { return unit_; }
    /// Every part as a group (Parts), and every light with all its parts as a group (Wholes). Only after Finish.
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
    double unit_ = 1;
    std::vector<LightId> infinite_;  ///< the first parts of infinite lights
    std::vector<LightId> environments_;
    std::unique_ptr<LightGroups> parts_, groupsOfWholes_;
};

}  // namespace pbrt
