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
    std::vector<LightId> SkyPartsOf(LightId infinite) const final { return inner_.SkyPartsOf(infinite); }
    const void *Weigh(const LightQuery &query, LightMemory &memory) const final {
        auto *inner = memory.Make<LightDistribution>();
        *inner = inner_.Within(query, memory);
        return inner;
    }
    LightId PartOf(const LightQuery &, const void *weights, LightId infinite, const Point3 &p,
                   const Vector3 &d) const final {
        return Inner(weights).PartTowards(infinite, p, d);
    }
    const LightSampler &inner_;
};

}  // namespace pbrt::test
