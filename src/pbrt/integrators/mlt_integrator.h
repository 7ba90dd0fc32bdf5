#pragma once
#include "pbrt/integrators/bdpt_integrator.h"

namespace pbrt {

struct MltSettings {
    int maxDepth = 5;
    bool regularize = false;
    /// Per sample of every pixel, which are independent of each other (MltIntegrator).
    int bootstrapSamples = 1000, chains = 10;
    Float largeStepProbability = 0.3f;
    Float sigma = 0.01f;  ///< standard deviation of small steps, for numbers in [0, 1)
};

/// Primary sample space Metropolis light transport (Kelemen et al. 2002): mutates the random numbers of a pair of
/// bidirectional subpaths; the target function is the contribution of all its connections to the film.
///
/// Each sample per pixel is an independent unit. Independent pairs (bootstrap) estimate the mean brightness; chains
/// start at some of them, selected by contribution, with one mutation per pixel in total. A unit's expectation is exact
/// for any size (Veach 1997, section 11.3.1). So the mean over units converges for every seed, and the render can be
/// divided between threads, processes and parts.
class MltIntegrator final : public Integrator {
  public:
    /// The camera must support Camera::CanConnect. Samplers as in BdptIntegrator; they stay as after Prepare, since a
    /// chain's state would otherwise hold lights selected by an earlier estimate.
    MltIntegrator(const PathContext &context, const MltSettings &settings,
                  std::unique_ptr<LightSampler> connecting = nullptr, std::unique_ptr<LightSampler> shooting = nullptr);
    void Prepare(PrepareContext &prepare) override { pairs_.Prepare(prepare); }
    const LightSampler *Lights() const override { return pairs_.Lights(); }
    const LightSampler *EmissionSampler() const override { return pairs_.EmissionSampler(); }
    /// Throws UserError if the film needs visible surfaces.
    bool Render(const RenderPass &pass) override;
    /// The bootstraps of all samples of a pass are in memory at once.
    int MaxPassSamples() const override { return 16; }

  private:
    struct Pair;
    struct Unit;
    class Renderer;
    PathContext context_;
    MltSettings settings_;
    BdptIntegrator pairs_;
};

}  // namespace pbrt
