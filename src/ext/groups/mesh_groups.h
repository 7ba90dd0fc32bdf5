#pragma once
#include <span>
#include <vector>

#include "pbrt/lights/light_table.h"
#include "pbrt/math/rng.h"

namespace ext {
using namespace pbrt;

/// Lights of a scene as things to choose from: the primitives of one emissive mesh are ONE group, every other light is a
/// group of its own. P(light | query) = P(group | query) * P(light | group); the second factor is the light's share of
/// the group's power and lives here, so that no two samplers can disagree about it.
class MeshGroups {
  public:
    /// `grouped` false: every light its own group.
    MeshGroups(const LightTable &lights, bool grouped);

    size_t Size() const { return candidates_.size(); }
    size_t LightCount() const { return groupOf_.size(); }
    /// Power (sum), bounds (union) and kind of each group; what group-level samplers select among.
    std::span<const LightCandidate> Candidates() const { return candidates_; }
    uint32_t GroupOf(LightId light) const { return groupOf_[light.value]; }
    /// Lights of a group: consecutive ids.
    uint32_t FirstOf(uint32_t group) const { return first_[group]; }
    uint32_t CountOf(uint32_t group) const { return first_[group + 1] - first_[group]; }

    /// P(light | its group). Discrete.
    Float ShareOf(LightId light) const { return share_[light.value]; }
    /// A light of the group with probability ShareOf.
    LightId SampleLight(uint32_t group, Float u) const;
    /// Uniform number for SampleLight from the one number of a selection: independent of which group that number chose,
    /// and fine enough for any number of triangles.
    static Float InnerNumber(Float u, const Point3 &p) { return HashFloat(u, p); }
    /// The same where the group was chosen because u is in [begin, begin + share): its place in there, so that what is well spread
    /// for u is well spread inside the group as well. Digits that u does not have come from a hash, all of them in small parts.
    static Float InnerNumber(Float u, const Point3 &p, Float begin, Float share) {
        constexpr Float kStep = 0x1p-24f, kSmall = 1e-3f;
        if (share < kSmall) return InnerNumber(u, p);
        return std::clamp((u - begin + kStep * HashFloat(u, p)) / share, Float(0), OneMinusEpsilon);
    }

    size_t Bytes() const;

  private:
    std::vector<LightCandidate> candidates_;
    std::vector<uint32_t> first_;    ///< per group, first light; one more entry at the end (lights of a group are contiguous)
    std::vector<uint32_t> groupOf_;  ///< per light
    std::vector<Float> share_;       ///< per light
    std::vector<Float> cdf_;         ///< per light: share of all lights of its group up to and including it
};

}  // namespace ext
