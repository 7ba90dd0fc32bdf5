#include "pbrt/samplers/sampler.h"

#include <bit>

#include "pbrt/math/rng.h"
#include "pbrt/samplers/halton_sampler.h"
#include "pbrt/samplers/pmj02bn_sampler.h"
#include "pbrt/samplers/random_samplers.h"
#include "pbrt/samplers/sobol_samplers.h"

namespace pbrt {

void Sampler::PrepareNext() {
    const int dimension = firstPrepared_ + next_;
    const Run run = Prepare(dimension, prepared_);
    firstPrepared_ = run.first;
    next_ = dimension - run.first;
    end_ = run.count;
}

std::unique_ptr<Sampler> Sampler::ForBatch(int index) const {
    if (index == 0) return Clone();
    const uint64_t mixed = MixBits(uint64_t(settings_.seed) * 0x10001 + uint64_t(index));
    return WithSeed(int(mixed & 0x7fffffff));
}

namespace {

constexpr int kMaxSamples = 1 << 30;
constexpr NamedValue<Randomization> kRandomizations[] = {{"none", Randomization::None},
                                                         {"permutedigits", Randomization::PermuteDigits},
                                                         {"owen", Randomization::Owen},
                                                         {"fastowen", Randomization::FastOwen}};
constexpr NamedValue<Randomization> kHaltonRandomizations[] = {kRandomizations[0], kRandomizations[1],
                                                               kRandomizations[2]};

struct SeedParams {
    std::optional<int> seed;
    void Describe(auto &&v) { v("seed", seed, "random seed; default: --seed or Option \"seed\""); }
    int Seed(const SamplerContext &context) const { return seed.value_or(context.seed); }
};

struct CountParams : SeedParams {
    int samples = 16;
    Randomization randomization = Randomization::None;
    void Describe(auto &&v) {
        v("pixelsamples", samples, Range<int>{1, kMaxSamples}, "samples per pixel; --spp overrides it");
        SeedParams::Describe(v);
    }
    SamplerSettings Settings(const SamplerContext &context) const {
        const int count = context.samplesPerPixel > 0 ? context.samplesPerPixel : samples;
        return {count, context.resolution, randomization, Seed(context)};
    }
};

struct IndependentParams : CountParams {
    IndependentParams() { samples = 4; }
};

template <Randomization kDefault, const auto &kChoices>
struct RandomizedParams : CountParams {
    RandomizedParams() { randomization = kDefault; }
    void Describe(auto &&v) {
        CountParams::Describe(v);
        v("randomization", randomization, kChoices, "randomization of the points");
    }
};
using HaltonParams = RandomizedParams<Randomization::PermuteDigits, kHaltonRandomizations>;
using SobolParams = RandomizedParams<Randomization::FastOwen, kRandomizations>;

struct StratifiedParams : SeedParams {
    bool jitter = true;
    int x = 4, y = 4;
    void Describe(auto &&v) {
        v("jitter", jitter, "random place in each cell; false: centre");
        v("xsamples", x, Range<int>{1, kMaxSamples}, "cell columns per pixel; --spp overrides xsamples, ysamples");
        v("ysamples", y, Range<int>{1, kMaxSamples}, "cell rows per pixel");
        SeedParams::Describe(v);
    }
};

std::unique_ptr<Sampler> MakeStratified(const StratifiedParams &p, const ParamSet &set, const SamplerContext &context) {
    int x = p.x, y = p.y;
    if (const int count = context.samplesPerPixel; count > 0) {
        // Most nearly equal factors of the count.
        for (y = int(std::sqrt(double(count)) + 0.5); y > 1 && count % y != 0;) --y;
        x = count / y;
    } else if (int64_t(x) * y > kMaxSamples) {
        throw set.Error("xsamples", "{} x {} samples per pixel are too many; at most 2^30 are allowed.", x, y);
    }
    return std::make_unique<StratifiedSampler>(x, y, p.jitter, p.Seed(context));
}

/// Warns unless samples per pixel are a power of kBase, 2 or 4; 1: any number will do.
template <class S, class P, int kBase = 1>
std::unique_ptr<Sampler> MakeSampler(const P &p, const ParamSet &set, const SamplerContext &context) {
    const SamplerSettings settings = p.Settings(context);
    const auto n = unsigned(settings.samplesPerPixel);
    if (kBase > 1 && (!std::has_single_bit(n) || (kBase == 4 && std::countr_zero(n) % 2 != 0)))
        set.Warn(context.sink, "pixelsamples",
                 fmt::format("{} samples per pixel are not a power of {}; this sampler is at its best with one.", n,
                             kBase == 2 ? "two" : "four"));
    return set.At("pixelsamples", [&] { return std::make_unique<S>(settings); });
}

}  // namespace

const SamplerTable &Samplers() {
    static const SamplerTable table("Sampler", [](SamplerTable &t) {
        t.Add<IndependentParams>("independent", "", MakeSampler<IndependentSampler, IndependentParams>);
        t.Add<StratifiedParams>("stratified", "", MakeStratified);
        t.Add<HaltonParams>("halton", "", MakeSampler<HaltonSampler, HaltonParams>);
        t.Add<SobolParams>("sobol", "", MakeSampler<SobolSampler, SobolParams, 2>);
        t.Add<SobolParams>("paddedsobol", "", MakeSampler<PaddedSobolSampler, SobolParams, 2>);
        t.Add<SobolParams>("zsobol", "", MakeSampler<ZSobolSampler, SobolParams, 2>);
        t.Add<CountParams>("pmj02bn", "the points are generated at startup and differ from stock pbrt-v4's",
                           MakeSampler<Pmj02bnSampler, CountParams, 4>);
    });
    return table;
}

}  // namespace pbrt
