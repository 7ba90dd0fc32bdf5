#pragma once
#include <atomic>

#include "ext/baselines/oracle/oracle_params.h"
#include "ext/lightgroups/emitter_tree.h"
#include "ext/lightgroups/interior_light_sampler.h"

namespace ext {

/// A measuring instrument, not a sampler to render with: at every shading point it traces its own shadow rays to every
/// light and chooses with the probabilities that minimise the variance of the estimate of direct light there
/// (least_variance.h). The errors of other samplers are compared with its error.
///
/// What is minimised: given the shading point, the direction it is seen from, its BSDF and the path's wavelengths, the
/// sum of the second moments of one light sample and one BSDF sample of direct light, combined by the power heuristic
/// (`mis` true), with the root mean square over the wavelengths as the value. With `mis` false: the second moment of
/// the light sample alone, that is p_l ~ sqrt(E[(f Le cos V / p(y))^2]).
///
/// What is taken as given: how a point on a light is drawn, how a primitive of a mesh is chosen (MeshInterior, as the
/// octree does), and where the paths go. No choice among the lights has a lower error; a sampler that chooses better
/// inside meshes or on a light could have. With `meshlights` false every primitive is measured, which gives the lower
/// limit for the choice inside meshes as well.
///
/// Why an image rendered with the oracle may have a little more error than the minimum: expectations are means over
/// `samples` light points; the share `floor` goes to the unoccluded estimate at the point (EmitterTree), so that a
/// light that none of the points saw can still be chosen and the mean of the image is right; the error of an image is
/// measured in colours, the oracle minimises it over wavelengths; and noise in a pixel comes from the rest of the path
/// as well.
///
/// Without a BSDF in the query the surface is a white diffuse one, of both sides if it transmits; in a medium
/// scattering is uniform. Random numbers depend on the seed and the query's position and direction only.
class OracleLightSampler final : public InteriorLightSampler {
  public:
    OracleLightSampler(const LightTable &lights, const OracleParams &params);

    /// The scene of the context must live as long as the sampler is used.
    void Prepare(PrepareContext &context) override;
    void Report(nlohmann::ordered_json &report) const override;
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override;

  private:
    const void *WeighGroups(const LightQuery &query, LightMemory &memory) const override;
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const override;
    Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const override;
    /// The running sums of the probabilities of the groups, in `memory`; null if no shadow ray found light.
    const Float *Measure(const LightQuery &query, LightMemory &memory) const;

    OracleParams params_;
    EmitterTree unoccluded_;        ///< over groups
    const Scene *scene_ = nullptr;  ///< null: not prepared, or at most one group: unoccluded_ alone
    int seed_ = 0;
    /// For Report only.
    mutable std::atomic<uint64_t> measured_{0}, rays_{0};
};

}  // namespace ext
