#pragma once
#include <algorithm>
#include <vector>

#include "pbrt/core/ids.h"
#include "pbrt/lights/light_bounds.h"
#include "pbrt/math/rng.h"

namespace pbrt {

class LightTable;

/// One thing a light sampler can choose: a component of a light, or several together.
struct LightCandidate {
    Float power = 0;                    ///< Phi at SampledWavelengths::WholeRange() over LightTable::Unit(), >= 0
    std::optional<LightBounds> bounds;  ///< phi in the same unit; empty: infinite (or no power)
    bool infinite = false;
};

/// The lights of a scene, divided into the groups that a light sampler chooses from: every light with all its
/// components is one group, or every component is a group. P(component | query) = P(group | query) * P(component |
/// group); the second factor is the component's share of the group's power and lives here, so that all samplers use the
/// same.
class LightGroups {
  public:
    /// `byLight` false: every component is a group. The table must outlive the groups.
    LightGroups(const LightTable &lights, bool byLight);

    size_t Size() const { return first_.empty() ? LightCount() : first_.size() - 1; }
    size_t LightCount() const { return lightCount_; }
    const LightTable &Lights() const { return lights_; }
    /// The power (sum), the bounds (union) and the kind of a group, by which samplers weigh it.
    LightCandidate Candidate(uint32_t group) const;
    std::vector<LightCandidate> Candidates() const;
    uint32_t GroupOf(LightId light) const { return first_.empty() ? light.value : LightOf(light); }
    /// The first component of a group and the number of its components, which have consecutive ids.
    uint32_t FirstOf(uint32_t group) const { return first_.empty() ? group : first_[group]; }
    uint32_t CountOf(uint32_t group) const { return first_.empty() ? 1 : first_[group + 1] - first_[group]; }

    /// P(light | its group). Discrete.
    Float ShareOf(LightId light) const { return share_.empty() ? Float(1) : share_[light.value]; }
    /// Chooses a component of the group with probability ShareOf; u in [0, 1).
    LightId SampleLight(uint32_t group, Float u) const {
        return first_.empty() ? LightId(group) : SampleWithin(group, u);
    }
    /// Makes the uniform number for SampleLight from the number u that chose the group: it is independent of the group
    /// that u chose, and fine enough for any number of components.
    static Float InnerNumber(Float u, const Point3 &p) { return HashFloat(u, p); }
    /// The same for a group that was chosen because u is in [begin, begin + share): the relative position of u in this
    /// interval, so that well-spread u are well spread inside the group as well. The bits that u lacks come from a
    /// hash, for small shares all bits.
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
    std::vector<Float> share_;     ///< per light; empty if no group has more than one
    std::vector<Float> cdf_;       ///< per light: share of all lights of its group up to and including it
};

}  // namespace pbrt
