#pragma once
#include <atomic>
#include <span>

#include "ext/lightgroups/emitter_tree.h"
#include "ext/lightgroups/mesh_interior.h"
#include "pbrt/core/describe.h"

namespace ext {

/// Point on a light, sampled with density p(y) (solid angle; discrete for delta lights) from the shading point.
struct LightPoint {
    Float value = 0;  ///< |f Le cos V / p(y)|: the contribution estimate from this point alone
    Float ratio = 0;  ///< BSDF sampling density of this direction over p(y); 0 if BSDF sampling cannot reach the point
};

/// Light selection probabilities that minimize the variance of the direct lighting estimate. Expectations over a light
/// are means over its points: `points` holds the same number of points for each light, light by light.
///
/// Without MIS (all ratios 0), the second moment of "select light l, sample y" is S(p) = sum_l m_l / p_l with m_l =
/// mean of value^2; its minimum is at p_l ~ sqrt(m_l).
///
/// With ratios r: one light sample and one BSDF sample, combined by the power heuristic with weights p_l^2/(p_l^2 +
/// r^2) and r^2/(p_l^2 + r^2). The summed second moment is S(p) = sum_l mean of value^2 (p_l^3 + r^3) / (p_l^2 +
/// r^2)^2, decreasing in every p_l. At the minimum all -dS/dp_l are equal, so p_l <- p_l sqrt(-dS/dp_l), normalized, is
/// iterated. One step is exact where r is 0. S can have several minima; the result was the lowest or within 2 % of it
/// in 200 random pairs of lights (tests/unit/ext/baselines/oracle).
///
/// Writes probabilities that sum to 1 to `pmf` (one per light). Returns false and leaves `pmf` unchanged if all values
/// are 0 or their sum overflows.
bool MinVariancePmf(std::span<const LightPoint> points, std::span<double> pmf);

struct OracleParams {
    int samples = 32;
    Float floor = 0.02f;
    bool mis = true;
    bool meshlights = true;
    bool interior = true;

    void Describe(auto &&v) {
        v("samples", samples, Range<int>{1, 4096}, "shadow rays to every light, each time a light is chosen");
        v("floor", floor, Range<Float>{1e-4f, 1.f},
          "share of the probability that follows unoccluded importance alone");
        v("mis", mis, "minimum variance of light and BSDF sampling combined; false: of light sampling alone");
        v("meshlights", meshlights,
          "an emissive mesh is one light for selection; false: every primitive is a light, with shadow rays of its "
          "own");
        v("interior", interior,
          "primitives of a mesh are chosen by importance at the point, as the octree does; false: by power");
    }
};

/// A reference for measurements, not for rendering: errors of other samplers are compared with its error. At every
/// shading point it traces shadow rays to every light and selects with the probabilities that minimize the variance of
/// direct lighting (MinVariancePmf; values are root mean squares over the wavelengths). Points on a light, primitives
/// in a mesh (MeshInterior, as in the octree) and paths are sampled as by others, so an image can have less error
/// (docs/method/baselines.md). The fraction `floor` goes to the unoccluded estimate (EmitterTree), so that unreached
/// lights can be selected and the image is unbiased.
///
/// Without a BSDF in the query the surface is white and diffuse, on both sides if it transmits; in a medium scattering
/// is isotropic. Random numbers depend on the seed and the query's position and direction only.
class OracleLightSampler final : public InteriorLightSampler {
  public:
    OracleLightSampler(const LightTable &lights, const OracleParams &params);

    /// The context's scene must outlive the sampler.
    void Prepare(PrepareContext &context) override;
    void Report(nlohmann::ordered_json &report) const override;
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override;

  private:
    const void *WeighGroups(const LightQuery &query, LightMemory &memory) const override {
        return scene_ ? Measure(query, memory) : nullptr;
    }
    std::optional<ChosenGroup> ChooseGroup(const LightQuery &query, const void *weights, Float u) const override;
    Float GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const override;
    /// CDF over the groups, in `memory`; null if no shadow ray reached a light.
    const Float *Measure(const LightQuery &query, LightMemory &memory) const;

    OracleParams params_;
    EmitterTree unoccluded_;        ///< over groups
    const Scene *scene_ = nullptr;  ///< null: not prepared, or at most one group; only unoccluded_ is used
    int seed_ = 0;
    mutable std::atomic<uint64_t> measured_{0}, rays_{0};
};

}  // namespace ext
