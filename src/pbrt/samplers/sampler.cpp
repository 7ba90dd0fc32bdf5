#include "pbrt/samplers/sampler.h"

#include <bit>

#include "pbrt/math/rng.h"
#include "pbrt/samplers/halton_sampler.h"
#include "pbrt/samplers/pmj02bn_sampler.h"
#include "pbrt/samplers/random_samplers.h"
#include "pbrt/samplers/randomization.h"
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
    const uint64_t mixed = MixBits(static_cast<uint64_t>(givenSeed_) * 0x10001 + static_cast<uint64_t>(index));
    return WithSeed(static_cast<int>(mixed & 0x7fffffff));
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
    template <class V>
    void Describe(V &&v) {
        v("seed", seed, "random seed; default: --seed or Option \"seed\"");
    }
    int Seed(const SamplerContext &context) const { return seed.value_or(context.seed); }
};

struct CountParams : SeedParams {
    int samples = 16;
    template <class V>
    void Describe(V &&v) {
        v("pixelsamples", samples, Range<int>{1, kMaxSamples}, "samples per pixel; --spp overrides it");
        SeedParams::Describe(v);
    }
    int Samples(const SamplerContext &context) const {
        return context.samplesPerPixel > 0 ? context.samplesPerPixel : samples;
    }
};

struct IndependentParams : CountParams {
    IndependentParams() { samples = 4; }
};

struct HaltonParams : CountParams {
    Randomization randomization = Randomization::PermuteDigits;
    template <class V>
    void Describe(V &&v) {
        CountParams::Describe(v);
        v("randomization", randomization, kHaltonRandomizations, "randomization of the points");
    }
};

struct SobolParams : CountParams {
    Randomization randomization = Randomization::FastOwen;
    template <class V>
    void Describe(V &&v) {
        CountParams::Describe(v);
        v("randomization", randomization, kRandomizations, "randomization of the points");
    }
};

struct StratifiedParams : SeedParams {
    bool jitter = true;
    int x = 4, y = 4;
    template <class V>
    void Describe(V &&v) {
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
        for (y = static_cast<int>(std::sqrt(double(count)) + 0.5); y > 1 && count % y != 0;) --y;
        x = count / y;
    } else if (int64_t(x) * y > kMaxSamples) {
        throw set.Error("xsamples",
                        fmt::format("{} x {} samples per pixel are too many; at most 2^30 are allowed.", x, y));
    }
    return std::make_unique<StratifiedSampler>(x, y, p.jitter, p.Seed(context));
}

std::unique_ptr<Sampler> MakePmj(const CountParams &p, const ParamSet &set, const SamplerContext &context) {
    const int samples = p.Samples(context);
    const auto n = static_cast<unsigned>(samples);
    if (!std::has_single_bit(n) || std::countr_zero(n) % 2 != 0)
        set.Warn(context.sink, "pixelsamples",
                 fmt::format("{} samples per pixel are not a power of four; this sampler is at its best with one.",
                             samples));
    return std::make_unique<Pmj02bnSampler>(samples, p.Seed(context));
}

int SobolSamples(const SobolParams &p, const ParamSet &set, const SamplerContext &context) {
    const int samples = p.Samples(context);
    if (!std::has_single_bit(static_cast<unsigned>(samples)))
        set.Warn(
            context.sink, "pixelsamples",
            fmt::format("{} samples per pixel are not a power of two; this sampler is at its best with one.", samples));
    return samples;
}

}  // namespace

const SamplerTable &Samplers() {
    static const SamplerTable table = [] {
        using Context = const SamplerContext;
        SamplerTable t("Sampler");
        t.Add<IndependentParams>("independent", "", [](const auto &p, const ParamSet &, Context &c) {
            return std::make_unique<IndependentSampler>(p.Samples(c), p.Seed(c));
        });
        t.Add<StratifiedParams>("stratified", "", MakeStratified);
        t.Add<HaltonParams>("halton", "", [](const auto &p, const ParamSet &, Context &c) {
            return std::make_unique<HaltonSampler>(p.Samples(c), c.resolution, p.randomization, p.Seed(c));
        });
        t.Add<SobolParams>("sobol", "", [](const auto &p, const ParamSet &set, Context &c) {
            return std::make_unique<SobolSampler>(SobolSamples(p, set, c), c.resolution, p.randomization, p.Seed(c));
        });
        t.Add<SobolParams>("paddedsobol", "", [](const auto &p, const ParamSet &set, Context &c) {
            return std::make_unique<PaddedSobolSampler>(SobolSamples(p, set, c), p.randomization, p.Seed(c));
        });
        t.Add<SobolParams>("zsobol", "", [](const auto &p, const ParamSet &set, Context &c) {
            return std::make_unique<ZSobolSampler>(SobolSamples(p, set, c), c.resolution, p.randomization, p.Seed(c));
        });
        t.Add<CountParams>("pmj02bn", "the points are generated at startup and differ from stock pbrt-v4's", MakePmj);
        return t;
    }();
    return table;
}

}  // namespace pbrt
