#include <gtest/gtest.h>

#include "pbrt/samplers/halton_sampler.h"
#include "support/sampling.h"

// Where the steps of the Halton sampler come from, and that it takes them.

namespace pbrt::test {
namespace {

constexpr Point2i kFilm(150, 100);
constexpr uint64_t kStride = 128 * 243;

uint32_t BaseOf(int dimension) { return Primes[dimension]; }

uint32_t MultiplierFor(int dimension, uint32_t step) {
    const uint32_t base = BaseOf(dimension), stride = kStride % base;
    for (uint32_t m = 1; m < base; ++m)
        if (m * stride % base == step) return m;
    return 0;
}

/// Searches the steps one after the other; each is the best one given those before it. The measure is the mean squared
/// error of the mean of n samples over the functions of a reproducing kernel space: the sum of a product kernel over
/// all pairs of samples. The kernel includes the last six dimensions and, as long as they matter, the two of the film.
/// The logarithms for all n = 4, 8, ... 64 are added, so a relative gain counts the same for few samples and for many.
class StepSearch {
  public:
    StepSearch() {
        for (int d : {0, 1}) kernels_.push_back(KernelOf([&](uint64_t a) { return FilmPosition(d, a); }));
    }
    /// The costs of all steps of the next dimension, from step 1 to half of the base; larger steps mirror these.
    std::vector<double> NextCosts() {
        const int d = int(kernels_.size());
        others_.assign(kOffsets * kPairs, 1);
        diagonal_ = 1;
        for (int j = 0; j < d; ++j) {
            const double weight = j < 2 ? (d >= 5 && d < 16 ? 0.3 : 0) : (d - j <= 6 ? 0.5 : 0);
            diagonal_ *= 1 + weight;
            for (size_t i = 0; i < others_.size(); ++i) others_[i] *= 1 + weight * kernels_[j][i];
        }
        std::vector<double> costs;
        for (uint32_t step = 1; step <= BaseOf(d) / 2; ++step) costs.push_back(CostOf(KernelOf(d, step)));
        return costs;
    }
    void Choose(int step) { kernels_.push_back(KernelOf(int(kernels_.size()), uint32_t(step))); }

  private:
    static constexpr int kSamples = 64;
    static constexpr size_t kOffsets = 2, kPairs = kSamples * (kSamples - 1) / 2;

    static double FilmPosition(int axis, uint64_t a) {
        return axis == 0 ? double(RadicalInverse(2, a / 128)) : double(RadicalInverse(3, a / 243));
    }
    /// The kernel of one dimension: the second Bernoulli polynomial of the distance on the circle, for all pairs of
    /// samples of two pixels.
    template <class Value>
    static std::vector<double> KernelOf(const Value &value) {
        std::vector<double> kernel;
        for (uint64_t first : {7919u, 23757u}) {
            std::array<double, kSamples> x;
            for (size_t i = 0; i < kSamples; ++i) {
                x[i] = value(first + i * kStride);
                for (size_t j = 0; j < i; ++j) {
                    const double t = std::abs(x[i] - x[j]);
                    kernel.push_back(6 * (t * t - t) + 1);
                }
            }
        }
        return kernel;
    }
    static std::vector<double> KernelOf(int d, uint32_t step) {
        const uint32_t multiplier = MultiplierFor(d, step);
        const auto seed = uint64_t(d);
        return KernelOf([&](uint64_t a) { return double(AffineRadicalInverse(BaseOf(d), a, multiplier, seed)); });
    }
    double CostOf(const std::vector<double> &kernel) const {
        double cost = 0;
        for (size_t o = 0, pair = 0; o < kOffsets; ++o) {
            double sum = 0;
            for (int i = 0; i < kSamples; ++i) {
                for (int j = 0; j < i; ++j, ++pair) sum += kernel[pair] * others_[pair];
                const int n = i + 1;
                if (n >= 4 && (n & (n - 1)) == 0) cost += std::log(std::max(0.01, 1 + 2 * sum / (diagonal_ * n)));
            }
        }
        return cost;
    }

    std::vector<std::vector<double>> kernels_;
    std::vector<double> others_;  ///< product of the kernels of all earlier dimensions
    double diagonal_ = 1;
};

TEST(HaltonSteps, AreThoseOfTheSearch) {
    StepSearch search;
    std::string found = "1, 1";
    bool same = true;
    for (int d = 2; d < HaltonSampler::StepCount; ++d) {
        const std::vector<double> costs = search.NextCosts();
        const auto best = std::min_element(costs.begin(), costs.end());
        const int step = int(best - costs.begin()) + 1;
        // On another machine rounding may decide a tie differently.
        const int listed = HaltonSampler::Step(d);
        if (listed < 1 || listed > int(costs.size()) || costs[listed - 1] > *best + 1e-9) same = false;
        found += fmt::format(", {}", step);
        search.Choose(same ? listed : step);
    }
    EXPECT_TRUE(same) << "The search finds\n" << found;
}

TEST(HaltonSteps, NumbersArePermutedByThem) {
    HaltonSampler sampler({16, kFilm, Randomization::PermuteDigits, 4});
    for (Point2i pixel : {Point2i(0, 0), Point2i(37, 91)})
        for (int i : {0, 5, 21}) {
            sampler.StartPixelSample(pixel, i);
            for (int d = 2; d < HaltonSampler::StepCount + 20; ++d) {
                const uint64_t a = sampler.Index(), seed = DigitPermutations::SeedOf(Hash(4), d);
                const Float expected =
                    d < HaltonSampler::StepCount
                        ? AffineRadicalInverse(BaseOf(d), a, MultiplierFor(d, uint32_t(HaltonSampler::Step(d))), seed)
                        : PermutedRadicalInverse(BaseOf(d), a, seed);
                ASSERT_NEAR(sampler.Get1D(), expected, 2e-7f) << i << " " << d;
            }
        }
}

}  // namespace
}  // namespace pbrt::test
