#pragma once
#include <numeric>

#include "ext/octree/learned_visibility_light_sampler.h"

namespace ext {

/// Visibility model of the octree sampler: unoccluded importance times learned visibility times BSDF.
///
///   P(l | x) = (1 - e) G_l(x) a(leaf, l) b_l(x) / sum + e G_l(x) / sum G
///
/// - G (GroupImportance): unoccluded irradiance at the shading point. In media, G has no cosine.
/// - a (VisibilityModel): learned visibility of the leaf, the root mean square of contribution over G. In media, a
///   includes transmittance.
/// - b: BSDF towards the light's centre on glossy surfaces without a diffuse lobe, or a peaked phase function; else 1.
///
/// Candidates l are all light groups, up to kMaxCandidates. Above that they are nodes of a per-leaf cut through a
/// LightTree, fine where the leaf's light comes from. Below a node, lights are selected level by level by G. Inside a
/// mesh, MeshInterior selects the primitive. Environment lights with portals (PortalSampling) are candidates with the G
/// and a of their regions.
class VisibilityOctreeLightSampler final : public LearnedVisibilityLightSampler {
  public:
    using LearnedVisibilityLightSampler::LearnedVisibilityLightSampler;

  private:
    /// Weights at a point. Environment lights with portals follow the local candidates.
    struct Candidates {
        static constexpr size_t kSize = kMaxCandidates + PortalSampling::kMaxLights;
        alignas(32) Float g[kSize], w[kSize];  ///< G, and G a b
        Float localG = 0;                      ///< sum of g of the local candidates
        Float perW = 0, perG = 0;              ///< P = w perW + g perG
        std::span<const uint32_t> nodes;       ///< of the light tree; empty: all groups in order
        size_t localCount = 0, totalCount = 0;
        const PortalSampling::Weights *portals = nullptr;

        Float Probability(size_t i) const { return w[i] * perW + g[i] * perG; }
        Float SumW() const { return std::accumulate(w, w + totalCount, Float(0)); }
    };
    void WeighCandidates(const LightQuery &query, const VisibilityTree *visibility, Candidates *c) const;
    void WeighScattering(const LightQuery &query, Candidates *c) const;
    const void *WeighGroups(const LightQuery &query, LightMemory &memory) const override;
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const override;
    Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const override;

    // Environment lights with portals: visibility_octree_portals.cpp.
    /// Appends them to the candidates.
    void WeighPortals(const LightQuery &query, LightMemory &memory, Candidates *c) const;
    std::optional<SampledLight> ChooseInside(const LightQuery &query, const void *weights, uint32_t group, Float u,
                                             Point2 *uPoint) const override;
    SampledLight ChoiceTowards(const LightQuery &query, const void *weights, LightId infinite, const Point3 &p,
                               const Vector3 &d) const override;
};

}  // namespace ext
