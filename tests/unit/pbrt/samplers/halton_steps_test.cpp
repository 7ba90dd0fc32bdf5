#include <gtest/gtest.h>

#include <numeric>

#include "pbrt/math/warps.h"
#include "pbrt/samplers/halton_sampler.h"
#include "support/sampling.h"

// Tests how evenly the few samples of a pixel of the Halton sampler fill the space of their dimensions.

namespace pbrt {
namespace {

constexpr Point2i kFilm(150, 100);
constexpr uint64_t kStride = 128 * 243;

uint32_t BaseOf(int dimension) { return Primes[static_cast<size_t>(dimension)]; }

uint32_t MultiplierFor(int dimension, uint32_t step) {
    const uint32_t base = BaseOf(dimension), stride = kStride % base;
    for (uint32_t m = 1; m < base; ++m)
        if (m * stride % base == step) return m;
    return 0;
}

// ---- Where the steps come from

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
        const int d = static_cast<int>(kernels_.size());
        others_.assign(kOffsets * kPairs, 1);
        diagonal_ = 1;
        for (int j = 0; j < d; ++j) {
            const double weight = j < 2 ? (d >= 5 && d < 16 ? 0.3 : 0) : (d - j <= 6 ? 0.5 : 0);
            diagonal_ *= 1 + weight;
            for (size_t i = 0; i < others_.size(); ++i) others_[i] *= 1 + weight * kernels_[static_cast<size_t>(j)][i];
        }
        std::vector<double> costs;
        for (uint32_t step = 1; step <= BaseOf(d) / 2; ++step) costs.push_back(CostOf(KernelOf(d, step)));
        return costs;
    }
    void Choose(int step) {
        kernels_.push_back(KernelOf(static_cast<int>(kernels_.size()), static_cast<uint32_t>(step)));
    }

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
        const auto seed = static_cast<uint64_t>(d);
        return KernelOf([&](uint64_t a) { return double(test::AffineRadicalInverse(BaseOf(d), a, multiplier, seed)); });
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

TEST(HaltonSteps, AreThoseThatTheSearchFinds) {
    StepSearch search;
    std::string found = "1, 1";
    bool same = true;
    for (int d = 2; d < HaltonSampler::StepCount; ++d) {
        const std::vector<double> costs = search.NextCosts();
        const auto best = std::min_element(costs.begin(), costs.end());
        const int step = static_cast<int>(best - costs.begin()) + 1;
        // On another machine rounding may decide a tie differently.
        const int listed = HaltonSampler::Step(d);
        if (listed < 1 || listed > static_cast<int>(costs.size()) ||
            costs[static_cast<size_t>(listed - 1)] > *best + 1e-9)
            same = false;
        found += fmt::format(", {}", step);
        search.Choose(same ? listed : step);
    }
    EXPECT_TRUE(same) << "The search finds\n" << found;
}

// ---- Against truly random permutations

/// The reference: the Halton sequence with truly random permutations of its digits, each made by a shuffle.
class ShuffledHalton {
  public:
    ShuffledHalton(int dimensions, uint64_t seed) {
        Rng rng(seed);
        for (int d = 0; d < dimensions; ++d)
            for (std::vector<uint32_t> &permutation : digits_.emplace_back(kDigits)) {
                permutation.resize(BaseOf(d));
                std::iota(permutation.begin(), permutation.end(), 0u);
                for (uint32_t n = BaseOf(d); n > 1; --n) std::swap(permutation[n - 1], permutation[rng.UniformInt(n)]);
            }
    }
    Float operator()(int dimension, uint64_t a) const {
        const uint32_t base = BaseOf(dimension);
        double value = 0, weight = 1;
        for (const std::vector<uint32_t> &permutation : digits_[static_cast<size_t>(dimension)]) {
            weight /= double(base);
            value += weight * permutation[a % base];
            a /= base;
        }
        return std::min(static_cast<Float>(value), OneMinusEpsilon);
    }

  private:
    static constexpr int kDigits = 8;
    std::vector<std::vector<std::vector<uint32_t>>> digits_;
};

/// The random numbers that a path uses at its first vertex: dimensions 6 to 11.
struct VertexNumbers {
    Float light;
    Point2 onLight;
    Float lobe;
    Point2 direction;
};

/// An integrand: a plane of directions with four disks of light of different sizes and the same power, seen in a glossy
/// lobe. One disk is chosen and sampled, the lobe is sampled, and the power heuristic combines both.
class Plates {
  public:
    explicit Plates(Float width) : width_(width) {}
    double operator()(const VertexNumbers &u) const {
        const auto chosen = std::min(3, static_cast<int>(u.light * 4));
        const Disk &disk = kDisks[chosen];
        const SineCosine theta = SineCosineOfTurn(u.onLight.y);
        const Point2 p = disk.centre + disk.radius * std::sqrt(u.onLight.x) * Point2(theta.cos, theta.sin);
        // The radiance of a disk is four times the density by area of a light sample, which is constant on a disk.
        const Float density = Density(disk);
        double L = double(4 * Lobe(p) * PowerHeuristic(density, Lobe(p)));
        const Float r = width_ * std::sqrt(u.direction.x / (1 - u.direction.x)), phi = 2 * Pi * u.direction.y;
        const Point2 q(r * std::cos(phi), r * std::sin(phi));
        for (const Disk &seen : kDisks)
            if (Distance2(q, seen.centre) <= Sqr(seen.radius))
                L += double(4 * Density(seen) * PowerHeuristic(Lobe(q), Density(seen)));
        return L;
    }

  private:
    struct Disk {
        Point2 centre;
        Float radius;
    };
    static constexpr Disk kDisks[4] = {
        {{-1.2f, 0.3f}, 0.1f}, {{-0.2f, 0.5f}, 0.2f}, {{0.6f, -0.6f}, 0.4f}, {{2, 0.8f}, 0.7f}};

    static Float Distance2(const Point2 &a, const Point2 &b) { return Sqr(a.x - b.x) + Sqr(a.y - b.y); }
    static Float Density(const Disk &disk) { return 1 / (4 * Pi * Sqr(disk.radius)); }
    /// The density of slopes of the Trowbridge-Reitz distribution.
    Float Lobe(const Point2 &p) const { return Sqr(width_) / (Pi * Sqr(Sqr(width_) + Sqr(p.x) + Sqr(p.y))); }

    Float width_;
};

/// The dimensions 6 to 11 of point n of a sequence.
template <class Sequence>
VertexNumbers NumbersOf(const Sequence &at, uint64_t n) {
    return {at(6, n), {at(7, n), at(8, n)}, at(9, n), {at(10, n), at(11, n)}};
}
VertexNumbers NumbersOf(HaltonSampler &sampler, Point2i pixel, int index) {
    sampler.StartPixelSample(pixel, index, 6);
    VertexNumbers u;
    u.light = sampler.Get1D();
    u.onLight = sampler.Get2D();
    u.lobe = sampler.Get1D();
    u.direction = sampler.Get2D();
    return u;
}

/// Mean squared errors of the mean of a pixel's samples, over pixels and seeds, relative to those of the reference.
struct ErrorShares {
    double sampler = 0, permuted = 0;
};
ErrorShares ComparePixels(const Plates &plates, int samples) {
    double truth = 0;
    constexpr int kTruth = 1 << 16;
    HaltonSampler many({kTruth, {1, 1}, Randomization::Owen, 3});
    for (int i = 0; i < kTruth; ++i) truth += plates(NumbersOf(many, {0, 0}, i)) / kTruth;

    double ofSampler = 0, ofPermuted = 0, ofTwin = 0;
    for (int seed = 0; seed < 60; ++seed) {
        HaltonSampler sampler({samples, kFilm, Randomization::PermuteDigits, seed});
        const ShuffledHalton twin(12, Hash(seed));
        auto permuted = [seed](int dimension, uint64_t n) {
            return PermutedRadicalInverse(BaseOf(dimension), n, Hash(seed, dimension));
        };
        for (int pixel = 0; pixel < 30; ++pixel) {
            double a = 0, b = 0, c = 0;
            for (int i = 0; i < samples; ++i) {
                a += plates(NumbersOf(sampler, {pixel * 37 % 128, pixel * 53 % 100}, i)) / samples;
                b += plates(NumbersOf(permuted, sampler.Index())) / samples;
                c += plates(NumbersOf(twin, sampler.Index())) / samples;
            }
            ofSampler += Sqr(a - truth);
            ofPermuted += Sqr(b - truth);
            ofTwin += Sqr(c - truth);
        }
    }
    return {ofSampler / ofTwin, ofPermuted / ofTwin};
}

TEST(HaltonSteps, PlatesHaveLessErrorThanWithRandomPermutations) {
    for (int samples : {4, 16, 64})
        for (Float width : {0.3f, 0.6f, 1.2f}) {
            const ErrorShares shares = ComparePixels(Plates(width), samples);
            EXPECT_LT(shares.sampler, 0.87) << samples << " samples, lobe " << width;
            // Hashed permutations are as good as shuffled ones, and are clearly worse than those of the sampler.
            EXPECT_NEAR(shares.permuted, 1, 0.12) << samples << " samples, lobe " << width;
        }
}

}  // namespace
}  // namespace pbrt
