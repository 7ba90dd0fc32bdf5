#pragma once
#include <functional>

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

/// A sampler whose probabilities are tampered with: those of samples and of PMF alike, or each in a way of its own.
class TamperedSampler final : public WrappedSampler {
  public:
    /// What takes the place of a choice's probability.
    using Change = std::function<Float(const LightQuery &, const SampledLight &)>;
    TamperedSampler(std::unique_ptr<LightSampler> inner, const Change &change)
        : TamperedSampler(std::move(inner), change, change) {}
    TamperedSampler(std::unique_ptr<LightSampler> inner, Change ofSamples, Change ofPmf)
        : WrappedSampler(*inner), inner_(std::move(inner)), ofSamples_(std::move(ofSamples)), ofPmf_(std::move(ofPmf)) {
    }
    void Prepare(PrepareContext &context) override { inner_->Prepare(context); }

  private:
    std::optional<SampledLight> Choose(const LightQuery &q, const void *weights, Float u,
                                       Point2 *uPoint) const override {
        std::optional<SampledLight> s = Inner(weights).Sample(u, uPoint);
        if (s) s->pmf = ofSamples_(q, *s);
        return s && s->pmf > 0 ? s : std::nullopt;
    }
    Float Probability(const LightQuery &q, const void *weights, LightId light) const override {
        return ofPmf_(q, {light, Inner(weights).PMF(light)});
    }
    SampledLight ChoiceTowards(const LightQuery &q, const void *weights, LightId infinite, const Point3 &p,
                               const Vector3 &d) const override {
        SampledLight choice = Inner(weights).Towards(infinite, p, d);
        choice.pmf = ofPmf_(q, choice);
        return choice;
    }

    std::unique_ptr<LightSampler> inner_;
    Change ofSamples_, ofPmf_;
};

}  // namespace pbrt::test
