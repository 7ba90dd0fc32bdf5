#pragma once
#include "pbrt/lightsamplers/light_sampler.h"

namespace pbrt::test {

/// For light samplers that change the answers of another one.
class WrappedSampler : public LightSampler {
  protected:
    /// `inner` must outlive this sampler.
    explicit WrappedSampler(const LightSampler &inner) : inner_(inner) {}
    /// The distribution of the inner sampler, from the `weights` that Choose and Probability get.
    static const LightDistribution &Inner(const void *weights) {
        return *static_cast<const LightDistribution *>(weights);
    }

  private:
    const void *Weigh(const LightQuery &query, LightMemory &memory) const final {
        auto *inner = memory.Make<LightDistribution>();
        *inner = inner_.Within(query, memory);
        return inner;
    }
    SampledLight ChoiceTowards(const LightQuery &query, const void *weights, LightId infinite, const Point3 &p,
                               const Vector3 &d) const override {
        SampledLight choice = Inner(weights).Towards(infinite, p, d);
        if (!(Probability(query, weights, infinite) > 0)) choice.pmf = 0;
        return choice;
    }
    const LightSampler &inner_;
};

}  // namespace pbrt::test
