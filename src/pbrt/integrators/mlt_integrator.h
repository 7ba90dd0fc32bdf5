#pragma once
#include <vector>

#include "pbrt/integrators/bdpt_integrator.h"
#include "pbrt/math/rng.h"
#include "pbrt/samplers/sampler.h"

namespace pbrt {

/// Returns numbers from a list, extended by uniform random numbers at its end. Refers to both.
class PrimarySampler final : public Sampler {
  public:
    PrimarySampler(std::vector<Float> &numbers, Rng &rng) : Sampler(SamplerSettings()), numbers_(numbers), rng_(rng) {}
    std::unique_ptr<Sampler> Clone() const override { return std::make_unique<PrimarySampler>(numbers_, rng_); }
    std::unique_ptr<Sampler> WithSeed(int) const override { return Clone(); }
    /// Truncates the list to the numbers prepared for use; those beyond are unused.
    void ForgetUnused() {
        if (used_ < numbers_.size()) numbers_.resize(used_);
    }

  protected:
    int StartSample(Point2i, int, int dimension) override { return dimension; }
    Run Prepare(int dimension, Numbers &numbers) override {
        used_ = std::max(used_, size_t(dimension) + kPrepared);
        while (numbers_.size() < used_) numbers_.push_back(rng_.Uniform());
        const Float *from = numbers_.data() + dimension;
        for (int i = 0; i < kPrepared; ++i) numbers.one[i] = from[i];
        for (int i = 0; i + 1 < kPrepared; ++i) numbers.two[i] = {from[i], from[i + 1]};
        return {dimension, kPrepared - 1};  // the last number has no successor yet
    }

  private:
    std::vector<Float> &numbers_;
    Rng &rng_;
    size_t used_ = 0;
};

/// Appends the numbers of `from` to `to`, each moved by a normally distributed step, modulo 1.
inline void PerturbNumbers(const std::vector<Float> &from, Float sigma, Rng &rng, std::vector<Float> &to) {
    const auto wrapped = [](Float v) { return std::min(v - std::floor(v), OneMinusEpsilon); };
    for (size_t i = 0; i < from.size(); i += 2) {
        // Two independent normal numbers (Box and Muller 1958).
        const Float radius = sigma * std::sqrt(-2 * std::log(1 - rng.Uniform())), angle = 2 * Pi * rng.Uniform();
        to.push_back(wrapped(from[i] + radius * std::cos(angle)));
        if (i + 1 < from.size()) to.push_back(wrapped(from[i + 1] + radius * std::sin(angle)));
    }
}

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
