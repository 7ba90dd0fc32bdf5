#pragma once
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/progress.h"
#include "pbrt/integrators/bdpt_integrator.h"
#include "pbrt/integrators/integrator.h"
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
    void DropUnused() {
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
                  std::unique_ptr<LightSampler> connecting = nullptr, std::unique_ptr<LightSampler> shooting = nullptr)
        : context_(context), settings_(settings),
          pairs_(context, settings.maxDepth, settings.regularize, std::move(connecting), std::move(shooting)) {
        pairs_.StopLearning();
    }
    void Prepare(PrepareContext &prepare) override { pairs_.Prepare(prepare); }
    const LightSampler *Lights() const override { return pairs_.Lights(); }
    const LightSampler *EmissionSampler() const override { return pairs_.EmissionSampler(); }
    /// Throws UserError if the film needs visible surfaces.
    bool Render(const RenderPass &pass) override {
        if (pass.film.NeedsVisibleSurface())
            throw UserError(
                "Integrator \"mlt\" has no camera rays of single pixels, so the film gets no visible surface: "
                "use Film \"rgb\" or \"spectral\" without further channels.");
        Renderer renderer(*this, pass);
        renderer.Bootstrap();
        return RenderChunks(pass, {.count = renderer.Chains(),
                                   .splat = true,
                                   .samplesOf = [&](int64_t i) { return renderer.MutationsOf(i); },
                                   .render = [&](int64_t i, uint32_t done) { return renderer.RenderChain(i, done); }});
    }
    /// The bootstraps of all samples of a pass are in memory at once.
    int MaxPassSamples() const override { return 16; }

  private:
    /// Minimum of one bootstrap pair per this many pixels, so that the brightness estimate improves with resolution.
    static constexpr int64_t kPixelsPerBootstrapPair = 8;
    /// Bootstrap pairs per task.
    static constexpr int64_t kGroup = 256;

    /// A pair of subpaths: its random numbers and its contribution to the film.
    struct Pair {
        std::vector<Float> numbers[3];                    ///< PrimarySampler; of light, camera and connections
        std::vector<BdptIntegrator::CameraSplat> splats;  ///< a film estimate per pair
        SampledWavelengths lambda;
        Float importance = 0;  ///< scalar sum of `splats`; positive wherever the film receives light
    };

    struct Unit {
        std::vector<Float> importance;   ///< per bootstrap pair
        std::vector<double> sums;        ///< inclusive running sums
        double mean = 0;                 ///< over all pairs
        Float first = 0;                 ///< start of the first chain in the sums, in [0, 1)
        size_t PairAt(double u) const {  ///< u in [0, 1)
            const auto at = std::upper_bound(sums.begin(), sums.end(), u * sums.back());
            size_t i = std::min(size_t(at - sums.begin()), sums.size() - 1);
            while (i > 0 && !(importance[i] > 0)) --i;  // rounding may lead past the last one
            return i;
        }
    };

    class Renderer {
      public:
        Renderer(const MltIntegrator &integrator, const RenderPass &pass)
            : integrator_(integrator), settings_(integrator.settings_), pass_(pass), bounds_(pass.film.PixelBounds()),
              pixels_(std::max<int64_t>(bounds_.Area(), 0)),
              chains_(std::clamp<int64_t>(settings_.chains, 1, std::max<int64_t>(pixels_, 1))),
              bootstrap_(std::max<int64_t>({settings_.bootstrapSamples, pixels_ / kPixelsPerBootstrapPair, 1})),
              low_(Point2(bounds_.low) + Float(0.5) - pass.filter.Radius()),
              size_(Point2(bounds_.high) - Float(0.5) + pass.filter.Radius() - low_), area_(size_.x * size_.y),
              differentialScale_(std::max(Float(0.125), 1 / std::sqrt(Float(pass.samplesPerPixel)))) {
            Sampler &sampler = *pass.samplers[0];
            sampler.StartPixelSample({0, 0}, 0);
            const Float u[] = {sampler.Get1D(), sampler.Get1D(), sampler.Get1D(), sampler.Get1D()};
            seed_ = Hash(u[0], u[1], u[2], u[3]);
        }

        int64_t Chains() const { return pixels_ > 0 ? pass_.count * chains_ : 0; }
        uint32_t MutationsOf(int64_t number) const {
            const int64_t chain = number % chains_;
            return uint32_t(pixels_ * (chain + 1) / chains_ - pixels_ * chain / chains_);
        }

        void Bootstrap() {
            units_.resize(Chains() / chains_);
            for (Unit &unit : units_) unit.importance.resize(bootstrap_);
            const int64_t groups = (bootstrap_ + kGroup - 1) / kGroup;
            ParallelForEach(groups * int64_t(units_.size()), [&](int64_t task) {
                Unit &unit = units_[task / groups];
                const int64_t begin = task % groups * kGroup, end = std::min(bootstrap_, begin + kGroup);
                Pair pair;
                for (int64_t i = begin; i < end && !pass_.progress.Cancelled(); ++i) {
                    MakePair(task / groups, i, pair);
                    unit.importance[i] = pair.importance;
                }
            });
            for (size_t i = 0; i < units_.size(); ++i) {
                Unit &unit = units_[i];
                double sum = 0;
                for (Float importance : unit.importance) unit.sums.push_back(sum += double(importance));
                unit.mean = sum / double(bootstrap_);
                unit.first = HashFloat(seed_, SampleOf(int64_t(i)), uint64_t{1});
            }
        }

        /// Runs the mutations of a chain. Those before `done` are already in the film.
        uint32_t RenderChain(int64_t number, uint32_t done) const {
            const int64_t unitIndex = number / chains_, chain = number % chains_;
            const Unit &unit = units_[unitIndex];
            const uint32_t all = MutationsOf(number);
            if (pass_.progress.Cancelled()) return done;
            if (!(unit.mean > 0)) return all;  // no light
            // Each start is uniform, and all of them are stratified.
            double u = double(unit.first) + double(chain) / double(chains_);
            u -= std::floor(u);
            Pair current, proposed;
            MakePair(unitIndex, int64_t(unit.PairAt(u)), current);
            Rng rng(Hash(seed_, SampleOf(unitIndex), chain, uint64_t{2}));
            const auto mean = Float(unit.mean);
            for (uint32_t i = 0; i < all; ++i) {
                if (pass_.progress.Cancelled()) return std::max(i, done);
                const bool isLarge = rng.Uniform() < settings_.largeStepProbability;
                for (int k = 0; k < 3; ++k) {
                    proposed.numbers[k].clear();
                    if (!isLarge) PerturbNumbers(current.numbers[k], settings_.sigma, rng, proposed.numbers[k]);
                }
                Trace(proposed, rng);
                const Float accept = std::min(Float(1), proposed.importance / current.importance);
                if (i >= done) {
                    if (accept > 0) AddToFilm(proposed, accept * (mean / proposed.importance));
                    if (accept < 1) AddToFilm(current, (1 - accept) * (mean / current.importance));
                }
                if (rng.Uniform() < accept) std::swap(current, proposed);
            }
            return all;
        }

      private:
        /// Sample index of a unit within the batch of the samplers.
        int64_t SampleOf(int64_t unit) const { return pass_.first + unit; }

        void MakePair(int64_t unit, int64_t index, Pair &pair) const {
            Rng rng(Hash(seed_, SampleOf(unit), index, uint64_t{0}));
            for (std::vector<Float> &numbers : pair.numbers) numbers.clear();
            Trace(pair, rng);
        }

        /// Evaluates the contribution of a pair's numbers, drawing missing ones.
        void Trace(Pair &pair, Rng &rng) const {
            PrimarySampler light(pair.numbers[0], rng), camera(pair.numbers[1], rng), connections(pair.numbers[2], rng);
            for (PrimarySampler *sampler : {&light, &camera, &connections}) sampler->StartPixelSample({0, 0}, 0);
            pair.splats.clear();
            pair.importance = 0;
            const Float uLambda = camera.Get1D();
            pair.lambda = pass_.film.SampleWavelengths(pass_.jittersWavelengths ? uLambda : Float(0.5));
            CameraSample sample;
            sample.pFilm = low_ + size_ * camera.Get2D();
            sample.time = camera.Get1D();
            sample.pLens = camera.Get2D();
            if (std::optional<CameraRay> ray = pass_.camera.GenerateRay(sample, pair.lambda)) {
                ray->differential.Scale(ray->ray, differentialScale_);
                const PathStart start{{*ray}, pass_};
                // Camera rays are spread over the area, so each represents all its pixels.
                const Float splatUnit = pass_.film.SplatUnit();
                const SampledSpectrum L = integrator_.pairs_.TracePair(start, pair.lambda, {light, camera, connections},
                                                                       area_, splatUnit, pair.splats);
                std::erase_if(pair.splats, [&](const BdptIntegrator::CameraSplat &s) { return !Reaches(s); });
                const BdptIntegrator::CameraSplat direct{sample.pFilm, ray->weight * L * (area_ * splatUnit)};
                if (Reaches(direct)) pair.splats.push_back(direct);
            }
            // Values beyond single precision are kept for the film to count, but attract no mutations.
            for (const BdptIntegrator::CameraSplat &s : pair.splats) {
                const Float sum = pair.importance + (pair.lambda.SecondaryTerminated() ? s.L[0] : s.L.Average());
                if (std::isfinite(sum)) pair.importance = sum;
            }
            for (PrimarySampler *sampler : {&light, &camera, &connections}) sampler->DropUnused();
        }
        /// True if the filtered film receives light from the splat.
        bool Reaches(const BdptIntegrator::CameraSplat &s) const {
            return s.L && s.pFilm.x >= low_.x && s.pFilm.y >= low_.y && s.pFilm.x <= low_.x + size_.x &&
                   s.pFilm.y <= low_.y + size_.y;
        }

        void AddToFilm(const Pair &pair, Float weight) const {
            if (!pass_.keepsSamples) return;
            for (const BdptIntegrator::CameraSplat &s : pair.splats)
                AddFilteredSplat(pass_.film, pass_.filter, s.pFilm, s.L * weight, pair.lambda);
        }

        const MltIntegrator &integrator_;
        const MltSettings &settings_;
        const RenderPass &pass_;
        const Bounds2i bounds_;
        const int64_t pixels_, chains_, bootstrap_;  ///< per unit
        const Point2 low_, size_;                    ///< film area covered by the pixels
        const Float area_, differentialScale_;
        uint64_t seed_ = 0;
        std::vector<Unit> units_;
    };

    PathContext context_;
    MltSettings settings_;
    BdptIntegrator pairs_;
};

}  // namespace pbrt
