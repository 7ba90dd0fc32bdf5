#pragma once
#include <vector>

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

}  // namespace pbrt
