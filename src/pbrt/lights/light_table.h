#pragma once
#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/core/ids.h"
#include "pbrt/lights/light.h"
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
    std::vector<LightCandidate> Candidates() const {
        std::vector<LightCandidate> all;
        for (uint32_t g = 0; g < Size(); ++g) all.push_back(Candidate(g));
        return all;
    }
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

    size_t Bytes() const {
        return candidates_.capacity() * sizeof(LightCandidate) + first_.capacity() * sizeof(uint32_t) +
               (share_.capacity() + cdf_.capacity()) * sizeof(Float);
    }

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

/// All lights of a scene in file order. A LightId is that of a component; those of a light are consecutive.
class LightTable {
  public:
    LightTable() = default;
    LightTable(const LightTable &) = delete;  // groups refer to their table
    LightTable &operator=(const LightTable &) = delete;

    /// Appends a light and returns the id of its first component. Not after Finish.
    LightId Add(std::unique_ptr<Light> light) {
        PBRT_CHECK(light && !byComponent_);
        const LightId first(lightOf_.size());
        if (light->Kind() == LightKind::Infinite) infinite_.push_back(first);
        lightOf_.insert(lightOf_.end(), light->ComponentCount(), uint32_t(lights_.size()));
        lights_.push_back({std::move(light), first.value});
        return first;
    }
    /// Sets every light's scene bounding sphere and builds the groups. Call once, after the last Add. `receivers`:
    /// bounds of the surfaces that do not emit; empty: unknown.
    void Finish(const Point3 &sceneCenter, Float sceneRadius, const Bounds3 &receivers = {});

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
    /// nonzero radiance, with the id of the light.
    void ForEachInfiniteEmission(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda,
                                 auto &&visit) const {
        for (LightId first : infinite_)
            if (SampledSpectrum Le = (*this)[first].Parent().Le(o, d, lambda)) visit(Le, first);
    }
    /// Power and bounds of a component, for light samplers. Only after Finish.
    LightCandidate Candidate(LightId id) const {
        const LightComponent light = (*this)[id];
        const bool infinite = light.Kind() == LightKind::Infinite || light.Kind() == LightKind::DeltaDirection;
        LightCandidate c{power_[id.value], light.Bounds(), infinite};
        if (c.bounds) c.bounds->phi /= unit_;
        return c;
    }
    /// Power of a candidate for the start of light paths: less for lights far outside the receivers, whose light hardly
    /// meets them. Positive if the power is; in its unit.
    Float PowerTowardsReceivers(const LightCandidate &candidate) const;
    /// First component so far outside the receivers that directions in single precision do not meet them: light paths
    /// that begin at it are lost.
    std::optional<LightId> FirstTooFarForLightPaths() const;
    /// Unit of candidate powers (as Light::Phi): the geometric mean of minimum and maximum component power over the
    /// scene radius. So powers, and powers over squared distances, neither overflow nor underflow in single precision.
    /// A power of two: division by it is exact.
    double Unit() const { return unit_; }
    /// Groups by component, and by light. Only after Finish.
    const LightGroups &ByComponent() const { return *byComponent_; }
    const LightGroups &ByLight() const { return *byLight_; }

  private:
    /// Distance of a light's bounding sphere from the receivers' centre, over the radius of the receivers' bounding
    /// sphere; 0 if unknown.
    double RadiiFromReceivers(const LightCandidate &candidate) const;

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
    Bounds3 receivers_;
};

}  // namespace pbrt
