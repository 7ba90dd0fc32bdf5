#include "pbrt/samplers/sampler.h"

#include <algorithm>

#include "pbrt/math/rng.h"
#include "pbrt/samplers/halton_sampler.h"
#include "pbrt/samplers/pmj02bn_sampler.h"
#include "pbrt/samplers/random_samplers.h"
#include "pbrt/samplers/randomization.h"
#include "pbrt/samplers/sobol_samplers.h"

namespace pbrt {

std::unique_ptr<Sampler> Sampler::ForBatch(int index) const {
    if (index == 0) return Clone();
    return WithSeed(static_cast<int>(MixBits(static_cast<uint64_t>(givenSeed_) * 0x10001 + static_cast<uint64_t>(index)) & 0x7fffffff));
}

const std::vector<std::string> &SupportedSamplers() {
    static const std::vector<std::string> names = {"independent", "stratified", "halton", "sobol",
                                                   "paddedsobol", "zsobol",     "pmj02bn"};
    return names;
}

Randomization ReadRandomization(const ParamSet &params, Randomization defaultValue, bool hasFastOwen) {
    struct Choice {
        const char *name;
        Randomization value;
    };
    static constexpr Choice kChoices[] = {{"none", Randomization::None},
                                          {"permutedigits", Randomization::PermuteDigits},
                                          {"owen", Randomization::Owen},
                                          {"fastowen", Randomization::FastOwen}};
    std::vector<std::string> names;
    std::string defaultName;
    for (const Choice &c : kChoices) {
        if (c.value == defaultValue) defaultName = c.name;
        if (c.value != Randomization::FastOwen || hasFastOwen) names.push_back(c.name);
    }
    std::string given = params.GetChoice("randomization", defaultName, names);
    return std::find_if(std::begin(kChoices), std::end(kChoices), [&](const Choice &c) { return given == c.name; })
        ->value;
}

namespace {

constexpr Range<int> kSampleRange{1, 1 << 30};

int ReadSamples(const ParamSet &params, int defaultValue, int sppOverride) {
    if (sppOverride <= 0) return params.GetInt("pixelsamples", defaultValue, kSampleRange);
    params.GetInt("pixelsamples", defaultValue);
    return sppOverride;
}

std::unique_ptr<Sampler> MakeStratified(const ParamSet &params, int sppOverride, int seed) {
    bool jitter = params.GetBool("jitter", true);
    int x = params.GetInt("xsamples", 4), y = params.GetInt("ysamples", 4);
    if (sppOverride > 0) {
        // The most square factors of the count.
        for (y = static_cast<int>(std::sqrt(double(sppOverride)) + 0.5); y > 1 && sppOverride % y != 0;) --y;
        x = sppOverride / y;
    } else {
        params.Require("xsamples", x, kSampleRange);
        params.Require("ysamples", y, kSampleRange);
        if (int64_t(x) * y > (1 << 30))
            throw UserError(fmt::format("{}: {} x {} samples are too many.", params.What(), x, y),
                            params.LocOf("xsamples"));
    }
    return std::make_unique<StratifiedSampler>(x, y, jitter, seed);
}

std::unique_ptr<Sampler> MakePmj02bnSampler(const ParamSet &params, int sppOverride, int seed, DiagnosticSink &sink) {
    int samples = ReadSamples(params, 16, sppOverride);
    auto n = static_cast<unsigned>(samples);
    if (!std::has_single_bit(n) || std::countr_zero(n) % 2 != 0)
        sink.Warning(params.LocOf("pixelsamples"),
                     fmt::format(
                         "{}: {} samples per pixel are not a power of four; this sampler is at its best with one.",
                         params.What(), samples));
    return std::make_unique<Pmj02bnSampler>(samples, seed);
}

std::unique_ptr<Sampler> MakeSobol(const std::string &type, const ParamSet &params, Point2i resolution, int sppOverride,
                                   int seed, DiagnosticSink &sink) {
    int samples = ReadSamples(params, 16, sppOverride);
    if (!std::has_single_bit(static_cast<unsigned>(samples)))
        sink.Warning(
            params.LocOf("pixelsamples"),
            fmt::format("{}: {} samples per pixel are not a power of two; this sampler is at its best with one.",
                        params.What(), samples));
    Randomization randomization = ReadRandomization(params, Randomization::FastOwen, true);
    if (type == "sobol") return std::make_unique<SobolSampler>(samples, resolution, randomization, seed);
    if (type == "paddedsobol") return std::make_unique<PaddedSobolSampler>(samples, randomization, seed);
    return std::make_unique<ZSobolSampler>(samples, resolution, randomization, seed);
}

}  // namespace

std::unique_ptr<Sampler> MakeSampler(const std::string &type, const ParamSet &params, Point2i resolution,
                                     int sppOverride, int defaultSeed, DiagnosticSink &sink) {
    std::unique_ptr<Sampler> sampler;
    int seed = params.GetInt("seed", defaultSeed);
    if (type == "independent")
        sampler = std::make_unique<IndependentSampler>(ReadSamples(params, 4, sppOverride), seed);
    else if (type == "stratified")
        sampler = MakeStratified(params, sppOverride, seed);
    else if (type == "halton") {
        int samples = ReadSamples(params, 16, sppOverride);
        Randomization randomization = ReadRandomization(params, Randomization::PermuteDigits, false);
        sampler = std::make_unique<HaltonSampler>(samples, resolution, randomization, seed);
    } else if (type == "sobol" || type == "paddedsobol" || type == "zsobol")
        sampler = MakeSobol(type, params, resolution, sppOverride, seed, sink);
    else if (type == "pmj02bn")
        sampler = MakePmj02bnSampler(params, sppOverride, seed, sink);
    else
        throw UserError(fmt::format("Sampler \"{}\" is unknown; {}.", type, ListChoices(type, SupportedSamplers())),
                        params.Loc());
    params.ReportUnused(sink);
    return sampler;
}

}  // namespace pbrt
