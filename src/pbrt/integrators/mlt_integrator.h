#pragma once
#include "pbrt/integrators/bdpt_integrator.h"

namespace pbrt {

struct MltSettings {
    int maxDepth = 5;
    bool regularize = false;
    /// Per sample of every pixel; each sample has its own (MltIntegrator).
    int bootstrapSamples = 1000, chains = 10;
    Float largeStepProbability = 0.3f;
    Float sigma = 0.01f;  ///< standard deviation of small steps, of numbers in [0, 1)
};

/// Metropolis light transport in the space of the random numbers that make a pair of bidirectional subpaths (Kelemen et
/// al. 2002): what is mutated are the numbers, and what counts is what all connections of the pair bring to the film.
///
/// A sample of every pixel is a unit of its own: pairs made of independent numbers (the bootstrap) estimate the mean
/// light, chains begin at some of them, chosen by the light that they bring, and have one mutation for each pixel
/// together. That makes the expectation of a unit exact, whatever its size (Veach 1997, section 11.3.1), so the mean
/// over units converges to the picture for every seed, and units are independent: a render can be divided between
/// threads, processes and parts like any other.
class MltIntegrator final : public Integrator {
  public:
    /// The camera can connect (Camera::CanConnect). The samplers: see BdptIntegrator. They are as Prepare
    /// leaves them for all chains: a chain keeps its state, and would keep lights chosen by an earlier estimate.
    MltIntegrator(const PathContext &context, const MltSettings &settings,
                  std::unique_ptr<LightSampler> connecting = nullptr, std::unique_ptr<LightSampler> shooting = nullptr);
    void Prepare(PrepareContext &prepare) override { pairs_.Prepare(prepare); }
    const LightSampler *Lights() const override { return pairs_.Lights(); }
    const LightSampler *EmissionSampler() const override { return pairs_.EmissionSampler(); }
    /// Throws UserError if the film needs the surfaces that the camera sees.
    bool Render(const RenderPass &pass) override;
    /// Bootstraps of all samples of a pass are in memory at once.
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
