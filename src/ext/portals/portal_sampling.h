#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ext/lightgroups/emitter.h"
#include "ext/portals/portal_search.h"
#include "ext/prepass/trial.h"
#include "ext/visibility/visibility_records.h"
#include "ext/visibility/visibility_tree.h"

namespace ext {

/// Samples environment lights through portals detected in a prepass. Selects the portal of a light for the shadow ray,
/// or the remainder of the light (EnvironmentPortals):
///
///   P(region | x, light) = (1 - e) G a / sum + e b
///
/// G of a portal is the integral of the radiance visible through it from x, times a mean cosine; of the remainder, that
/// of the whole light. a is the learned visibility in the leaf of x (VisibilityTreeBuilder). The floor b is one half
/// for the remainder; the other half is divided among the portals by G.
class PortalSampling {
  public:
    static constexpr size_t kMaxLights = 4;  ///< maximum number of environment lights with portals
    static constexpr size_t kMaxRegions = EnvironmentPortals::kMax + 1;
    static constexpr size_t kRaysPerLight = 16;  ///< environment rays per prepass vertex and light, with many vertices

    /// `mode`: "auto" (IsOnTrial), "always" or "never". `groups`: the caller's light groups.
    PortalSampling(const LightGroups &groups, const std::string &mode, Float floor);

    /// False if portals are off, or a trial should decide and there can be none.
    bool IsWanted(const PrepareContext &context) const {
        return !environments_.empty() && (!isOnTrial_ || CanTrace(context));
    }
    size_t RaysPerVertex() const { return environments_.size() * kRaysPerLight; }  ///< rays per vertex traced by Find
    /// Detects portals, if few enough environment rays leave the scene, and learns their visibility. Several progress
    /// phases.
    void Find(PrepareContext &context, std::span<const PrepassVertex> vertices);
    void Clear();

    bool IsOnTrial() const { return isOnTrial_; }  ///< true if a trial decides whether portals that were found are used
    /// Selects between the portals found and lights without portals, for a trial.
    void SetActive(bool active) { isActive_ = active && count_ > 0; }
    /// Takes the trial of portals relative to lights without them, and discards the portals unless they pay. Returns
    /// whether they do; they are still inactive.
    bool EndTrial(const TrialRatio &result);
    /// Cost of active portals per path vertex of the scene, in the unit of CompareTrials.
    double CostPerVertex(const Scene &scene) const;

    bool IsActive() const { return isActive_; }
    size_t Count() const { return IsActive() ? environments_.size() : 0; }  ///< number of lights with portals
    uint32_t GroupOf(size_t k) const { return environments_[k].group; }
    /// Index of the light with portals that is this group; Count() if none.
    size_t IndexOf(uint32_t group) const {
        size_t k = 0;
        while (k < Count() && environments_[k].group != group) ++k;
        return k;
    }

    struct Weights {
        /// Sums over the regions of a light, for light selection: of G (unoccluded irradiance) and of G a.
        Float g[kMaxLights], w[kMaxLights];
        Float region[kMaxLights][kMaxRegions];  ///< discrete probabilities, given the light
    };
    const Weights *Weigh(const LightQuery &query, LightMemory &memory) const;
    /// Samples a region of light k; probability given the light. `u`: uniform on the unit square; remapped to stay
    /// uniform, for the point on the light.
    std::optional<SampledLight> Sample(const Weights &weights, size_t k, Point2 *u) const;
    /// Region of light k in direction d (unit) from p, with its probability given the light.
    SampledLight Towards(const Weights &weights, size_t k, const Point3 &p, const Vector3 &d) const;

    void Save(StateWriter &out) const;
    /// Throws UserError if the saved state does not match the lights.
    void Load(StateReader &in);
    void Report(nlohmann::ordered_json &report) const;
    void Inspect(const Point3 &p, std::vector<InspectedValue> &values) const;
    std::string Describe() const;  ///< trial and portals as text; empty without both
    size_t Bytes() const;

  private:
    struct Environment {
        LightId id{};
        uint32_t group = 0;
        const EnvironmentLight *light = nullptr;
        Emitter outside;    ///< the light outside portals; dark if it is never sampled there
        Float perMean = 0;  ///< unit of G over that of EnvironmentPortals::IntegralAround
        std::optional<EnvironmentPortals> portals{};
    };
    size_t RegionCount() const { return count_ + 1; }
    static EnvironmentRegion RegionOf(const Environment &e, size_t region) { return {&*e.portals, uint32_t(region)}; }
    void Use(std::span<const Portal> portals);
    void Evaluate(const LightQuery &query, const Environment &e, Float *g) const;
    bool Learn(PrepareContext &context, std::span<const PrepassVertex> vertices);

    const LightTable &lights_;
    bool isOnTrial_, isActive_ = false;
    Float floor_;
    std::vector<Environment> environments_;
    std::vector<LightId> ids_;  ///< of environments_
    size_t count_ = 0;          ///< number of portals
    VisibilityTree tree_;
    TrialRatio trial_;
    double seconds_ = 0, seenShare_ = 0;  ///< detection time; fraction of its rays that left the scene
};

}  // namespace ext
