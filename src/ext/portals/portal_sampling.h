#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ext/lightgroups/emitter.h"
#include "ext/portals/portal_search.h"
#include "ext/visibility/visibility_records.h"
#include "ext/visibility/visibility_tree.h"

namespace ext {

/// Samples environment lights through portals that it finds in a prepass. It chooses the portal of a light that gets
/// the shadow ray, or the rest of the light (EnvironmentPortals):
///
///   P(region | x, light) = (1 - e) G a / sum + e b
///
/// G of a portal is the integral of the radiance over what x sees of it, times a mean cosine; of the rest, that of the
/// whole light. a is the learned visibility in the leaf of x (VisibilityTreeBuilder). b, the floor, gives one half to
/// the rest, and the other half to the portals by G.
class PortalSampling {
  public:
    /// At most so many environment lights are divided.
    static constexpr size_t kMaxLights = 4;
    static constexpr size_t kMaxRegions = EnvironmentPortals::kMax + 1;

    /// `mode`: "auto" (where no local lights shine), "always" or "never". `groups`: the caller's groups of lights.
    PortalSampling(const LightGroups &groups, const std::string &mode, Float floor);

    /// False if no portals are to be found.
    bool IsWanted() const { return !environments_.empty(); }
    /// Rays that Find traces from a vertex.
    size_t RaysPerVertex() const { return environments_.size() * kEnvironmentRaysPerVertex; }
    /// Finds portals, if little enough of the environment lights is seen, and learns their visibility. Several phases
    /// of the context's progress.
    void Find(PrepareContext &context, std::span<const PrepassVertex> vertices);
    /// Samples the lights as a whole again.
    void Clear();

    /// True if there are portals.
    bool IsActive() const { return count_ > 0; }
    /// The divided lights; 0 without portals.
    size_t Count() const { return IsActive() ? environments_.size() : 0; }
    uint32_t GroupOf(size_t k) const { return environments_[k].group; }
    /// The divided light that is this group; Count() if it is none of them.
    size_t IndexOf(uint32_t group) const {
        size_t k = 0;
        while (k < Count() && environments_[k].group != group) ++k;
        return k;
    }

    struct Weights {
        /// Sums over the regions of a light, for the choice among lights: of G, the unoccluded irradiance, and of G a.
        Float g[kMaxLights], w[kMaxLights];
        Float region[kMaxLights][kMaxRegions];  ///< discrete probabilities, given the light
    };
    const Weights *Weigh(const LightQuery &query, LightMemory &memory) const;
    /// A region of light k and its probability, given the light. `u`: uniform on the unit square; the rest of it, for
    /// the point on the light, is uniform again.
    std::optional<SampledLight> Sample(const Weights &weights, size_t k, Point2 *u) const;
    /// The region of light k in direction d (unit) from p and its probability, given the light.
    SampledLight Towards(const Weights &weights, size_t k, const Point3 &p, const Vector3 &d) const;

    void Save(StateWriter &out) const;
    /// Throws UserError if what was saved does not fit the lights.
    void Load(StateReader &in);
    void Report(nlohmann::ordered_json &report) const;
    void Inspect(const Point3 &p, std::vector<InspectedValue> &values) const;
    /// The portals as lines of text; empty without portals.
    std::string Describe() const;
    size_t Bytes() const;

  private:
    struct Environment {
        LightId id{};
        uint32_t group = 0;
        const EnvironmentLight *light = nullptr;
        Emitter whole;      ///< dark if the whole light is never sampled
        Float perMean = 0;  ///< G's unit over that of EnvironmentPortals::Integral
        std::optional<EnvironmentPortals> portals{};
    };
    size_t RegionCount() const { return count_ + 1; }
    static EnvironmentRegion RegionOf(const Environment &e, size_t region) {
        return {&*e.portals, static_cast<uint32_t>(region)};
    }
    void Use(std::span<const Portal> portals);
    /// G of the regions of a light.
    void Evaluate(const LightQuery &query, const Environment &e, Float *g) const;
    bool Learn(PrepareContext &context, std::span<const PrepassVertex> vertices);
    /// One shadow ray to each region of each light.
    std::vector<ShadowRay> TraceRegions(PrepareContext &context, const PrepassVertex &vertex, uint64_t seed) const;

    const LightTable &lights_;
    bool always_;
    Float floor_;
    std::vector<Environment> environments_;
    std::vector<LightId> ids_;  ///< of environments_
    size_t count_ = 0;          ///< of portals
    VisibilityTree tree_;
    double seconds_ = 0, seenShare_ = 0;  ///< of the search; share of its rays that left the scene
};

}  // namespace ext
