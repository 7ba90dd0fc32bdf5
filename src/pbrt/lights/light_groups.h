#pragma once
#include <algorithm>
#include <vector>

#include "pbrt/core/ids.h"
#include "pbrt/lights/light_bounds.h"
#include "pbrt/math/rng.h"

namespace pbrt {

class LightTable;

/// A selectable unit of a light sampler: one or several light components.
struct LightCandidate {
    Float power = 0;                    ///< Phi at SampledWavelengths::WholeRange() over LightTable::Unit(), >= 0
    std::optional<LightBounds> bounds;  ///< phi in the same unit; empty: infinite, or no power
    bool infinite = false;
};

/// Partition of a scene's lights into groups for light samplers: each light with all its components, or each component.
/// P(component | query) = P(group | query) * P(component | group). The second factor, the component's share of the
/// group's power, is defined here for all samplers.
class LightGroups {
  public:
    /// `byLight` false: every component is a group. The table must outlive the groups.
    LightGroups(const LightTable &lights, bool byLight);

    size_t Size() const { return first_.empty() ? LightCount() : first_.size() - 1; }
    size_t LightCount() const { return lightCount_; }
    const LightTable &Lights() const { return lights_; }
    /// Power (sum) and bounds (union) of a group.
    LightCandidate Candidate(uint32_t group) const;
    std::vector<LightCandidate> Candidates() const;
    uint32_t GroupOf(LightId light) const { return first_.empty() ? light.value : LightOf(light); }
    /// First component of a group and its component count; ids are consecutive.
    uint32_t FirstOf(uint32_t group) const { return first_.empty() ? group : first_[group]; }
    uint32_t CountOf(uint32_t group) const { return first_.empty() ? 1 : first_[group + 1] - first_[group]; }

    /// P(light | its group). Discrete.
    Float ShareOf(LightId light) const { return share_.empty() ? Float(1) : share_[light.value]; }
    /// Selects a component with probability ShareOf; u in [0, 1).
    LightId SampleLight(uint32_t group, Float u) const {
        return first_.empty() ? LightId(group) : SampleWithin(group, u);
    }
    /// Uniform number for SampleLight from the number u that selected the group: independent of the group, and with
    /// enough bits for any number of components.
    static Float InnerNumber(Float u, const Point3 &p) { return HashFloat(u, p); }
    /// The same for a group selected because u is in [begin, begin + share): u's relative position in the interval,
    /// which preserves stratification within the group. Bits that u lacks come from a hash, for small shares all bits.
    static Float InnerNumber(Float u, const Point3 &p, Float begin, Float share) {
        constexpr Float kStep = 0x1p-24f, kSmall = 1e-3f;
        if (share < kSmall) return InnerNumber(u, p);
        return std::clamp((u - begin + kStep * HashFloat(u, p)) / share, Float(0), OneMinusEpsilon);
    }

    size_t Bytes() const;

  private:
    uint32_t LightOf(LightId light) const;
    LightId SampleWithin(uint32_t group, Float u) const;

    const LightTable &lights_;
    size_t lightCount_;
    // All four are empty if every component is a group.
    std::vector<LightCandidate> candidates_;
    std::vector<uint32_t> first_;  ///< per group, its first light; one more entry at the end
    std::vector<Float> share_;     ///< per light; empty if all groups are single lights
    std::vector<Float> cdf_;       ///< per light: inclusive running sum of shares in its group
};

}  // namespace pbrt
