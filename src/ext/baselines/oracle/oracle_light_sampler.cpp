#include "ext/baselines/oracle/oracle_light_sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "pbrt/core/counters.h"
#include "pbrt/core/effective_params_text.h"
#include "pbrt/core/log.h"
#include "pbrt/integrators/registry.h"
#include "pbrt/scene/scene.h"

namespace ext {
namespace {
constexpr int kMaxSteps = 30;
constexpr double kTolerance = 1e-3;

/// -dS/dp times p^2 for one point of value 1, computed relative to max(p, r) to avoid under- and overflow: 1 for r = 0.
/// Never negative: x^3 - 3x + 4 > 0 for x = p/r >= 0.
double Gain(double p, double r) {
    const double s = std::max(p, r);
    p /= s;
    r /= s;
    const double d = p * p + r * r;
    return p * p * p * (p * p * p - 3 * p * r * r + 4 * r * r * r) / (d * d * d);
}

constexpr uint64_t kStream = 0x6f7261636c65ull;  ///< decorrelates this sampler from other uses of the seed

/// f cos towards wi, and the BSDF sampling density there.
struct Scattered {
    SampledSpectrum fCos;
    Float pdf = 0;  ///< solid angle
};

Scattered ScatteredTo(const LightQuery &q, const Vector3 &wi, bool needsPdf) {
    if (q.ns == Normal3(0)) return {SampledSpectrum(1 / (4 * Pi)), 1 / (4 * Pi)};
    Float cosine = Dot(wi, q.ns);
    if (q.bsdf && q.lambda) {
        SampledSpectrum f = q.bsdf->F(q.wo, wi) * std::abs(cosine);
        return {f, f && needsPdf ? q.bsdf->Pdf(q.wo, wi) : 0};
    }
    if (q.transmits) return {SampledSpectrum(std::abs(cosine) / (2 * Pi)), std::abs(cosine) / (2 * Pi)};
    if (cosine * Dot(q.wo, q.ns) <= 0) return {};
    return {SampledSpectrum(std::abs(cosine) / Pi), std::abs(cosine) / Pi};
}

Float Fraction(double v) { return std::min(Float(v - std::floor(v)), OneMinusEpsilon); }

}  // namespace

bool MinVariancePmf(std::span<const LightPoint> points, std::span<double> pmf) {
    const size_t lights = pmf.size(), perLight = lights ? points.size() / lights : 0;
    auto of = [&](size_t light) { return points.subspan(light * perLight, perLight); };
    auto root = [&](size_t light) {
        double m = 0;
        for (const LightPoint &y : of(light)) m += Sqr(double(y.value));
        return std::sqrt(m);
    };
    double total = 0;
    for (size_t l = 0; l < lights; ++l) total += root(l);
    if (!(total > 0) || !std::isfinite(total)) return false;
    for (size_t l = 0; l < lights; ++l) pmf[l] = root(l) / total;
    const bool anyRatio = std::ranges::any_of(points, [](const LightPoint &y) { return y.value > 0 && y.ratio > 0; });
    if (!anyRatio || lights == 1) return true;

    for (int step = 0; step < kMaxSteps; ++step) {
        double sum = 0, smallest = std::numeric_limits<double>::infinity(), largest = 0;
        for (size_t l = 0; l < lights; ++l) {
            double p = pmf[l], gain = 0;
            if (!(p > 0)) continue;
            for (const LightPoint &y : of(l)) gain += Sqr(double(y.value)) * Gain(p, double(y.ratio));
            double target = std::sqrt(gain);  // unnormalized
            if (p > kTolerance) {
                smallest = std::min(smallest, target / p);
                largest = std::max(largest, target / p);
            }
            // Half a step in the logarithm: a full step can oscillate around the minimum.
            sum += pmf[l] = std::sqrt(p * target);
        }
        for (size_t l = 0; l < lights; ++l) pmf[l] /= sum;
        if (largest <= smallest * (1 + kTolerance)) break;
    }
    return true;
}

OracleLightSampler::OracleLightSampler(const LightTable &lights, const OracleParams &params)
    : InteriorLightSampler(lights, params.meshlights, params.interior), params_(params),
      unoccluded_(GroupImportance::EmittersOf(groups_)) {}

void OracleLightSampler::Prepare(PrepareContext &context) {
    if (groups_.Size() <= 1) return;
    scene_ = &context.scene;
    seed_ = context.seed;
    LogWarning(
        "oracle: this measuring instrument is slow: {} lights x {} samples = up to {} shadow rays at every path "
        "vertex.",
        groups_.Size(), params_.samples, groups_.Size() * params_.samples);
}

const Float *OracleLightSampler::Measure(const LightQuery &query, LightMemory &memory) const {
    const SampledWavelengths &lambda = query.bsdf && query.lambda ? *query.lambda : SampledWavelengths::WholeRange();
    const LightSampleContext from{query.p, query.pError, query.n, query.ns, query.time};
    const size_t groupCount = groups_.Size();
    const size_t k = params_.samples;

    thread_local std::vector<LightPoint> points;
    thread_local std::vector<double> pmf;
    points.assign(groupCount * k, LightPoint());
    pmf.assign(groupCount, 0.0);

    RenderCounters &counters = ThreadCounters();
    const RenderCounters before = counters;  // not counted as rays of the render
    Rng rng(Hash(kStream, seed_, query.p, query.wo));
    for (uint32_t g = 0; g < groupCount; ++g) {
        const double shift[3] = {double(rng.Uniform()), double(rng.Uniform()), double(rng.Uniform())};
        for (size_t i = 0; i < k; ++i) {
            // Additive recurrence with reciprocal powers of the root of x^4 = x + 1: evenly distributed for any number.
            const auto at = double(i);
            std::optional<SampledLight> chosen =
                interior_.Sample(g, query, Fraction(shift[0] + at * 0.5497004779019703));
            if (!chosen) continue;
            const LightComponent light = scene_->Lights()[chosen->light];
            Point2 u(Fraction(shift[1] + at * 0.8191725133961645), Fraction(shift[2] + at * 0.6710436067037893));
            std::optional<LightLiSample> sample = light.SampleLi(from, u, lambda, true);
            if (!sample || !sample->L || !(sample->pdf > 0)) continue;
            const bool findable = params_.mis && !IsDelta(light.Kind());
            Scattered scattered = ScatteredTo(query, sample->wi, findable);
            const Float pLight = chosen->pmf * sample->pdf;
            // RMS over the wavelengths, because errors are squared per wavelength.
            const double value = RootMeanSquare(sample->L * scattered.fCos) / double(pLight) / scene_->Lights().Unit();
            if (!(value > 0) || !std::isfinite(value) || scene_->Occluded(from, *sample)) continue;
            points[g * k + i] = {Float(value), findable ? scattered.pdf / pLight : 0};
        }
    }
    rays_.fetch_add(counters.shadowRays - before.shadowRays, std::memory_order_relaxed);
    measured_.fetch_add(1, std::memory_order_relaxed);
    counters = before;

    if (!MinVariancePmf(points, pmf)) return nullptr;
    auto *cdf = memory.Make<Float>(groupCount);
    double running = 0;
    size_t last = 0;
    for (size_t g = 0; g < groupCount; ++g) {
        running += pmf[g];
        if (pmf[g] > 0) last = g;
        cdf[g] = Float(std::min(running, 1.0));
    }
    std::fill(cdf + last, cdf + groupCount, Float(1));
    return cdf;
}

std::optional<GroupLightSampler::ChosenGroup> OracleLightSampler::ChooseGroup(const LightQuery &query,
                                                                              const void *weights, Float u) const {
    const auto *cdf = static_cast<const Float *>(weights);
    const Float floor = cdf ? params_.floor : 1;
    ChosenGroup chosen;
    if (u < floor) {
        std::optional<SampledLight> g = unoccluded_.Sample(query, std::min(u / floor, OneMinusEpsilon));
        if (!g) return {};
        chosen = {.group = g->light.value, .inner = LightGroups::InnerNumber(u, query.p)};
    } else {
        chosen = SampleCdf({cdf, groups_.Size()}, query, std::min((u - floor) / (1 - floor), OneMinusEpsilon));
    }
    chosen.pmf = GroupProbability(query, weights, chosen.group);
    return chosen;
}

Float OracleLightSampler::GroupProbability(const LightQuery &query, const void *weights, uint32_t group) const {
    const auto *cdf = static_cast<const Float *>(weights);
    const Float unoccluded = unoccluded_.PMF(query, group);
    if (!cdf) return unoccluded;
    return (1 - params_.floor) * CdfPMF({cdf, groups_.Size()}, group) + params_.floor * unoccluded;
}

void OracleLightSampler::Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const {
    size_t visible = 0;
    LightMemory memory;
    const Float *cdf = scene_ && groups_.Size() > 1 ? Measure(query, memory) : nullptr;
    for (uint32_t g = 0; cdf && g < groups_.Size(); ++g) visible += CdfPMF({cdf, groups_.Size()}, g) > 0;
    values.push_back({"visible lights", double(visible), false});
}

void OracleLightSampler::Report(nlohmann::ordered_json &report) const {
    const uint64_t measured = measured_, rays = rays_;
    report["parameters"] = EffectiveParamsText(params_);
    report["note"] =
        "The oracle is a measuring instrument; its render time is not comparable with that of other light samplers.";
    GroupLightSampler::Report(report);
    report["maxShadowRaysPerVertex"] = scene_ ? groups_.Size() * params_.samples : 0;
    report["ownShadowRays"] = rays;
    report["ownShadowRaysPerVertex"] = measured ? double(rays) / double(measured) : 0.0;
}

}  // namespace ext

void register_oracle(pbrt::PluginRegistry &registry) {
    using namespace ext;
    registry.Add<OracleLightSampler, OracleParams>(
        "oracle",
        "Measuring instrument, slow: traces shadow rays to every light at every point for the choice of minimum variance.",
        {.isInstrument = true});
}
