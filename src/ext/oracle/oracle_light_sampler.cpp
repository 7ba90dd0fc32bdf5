#include "ext/oracle/oracle_light_sampler.h"

#include <algorithm>
#include <cstring>

#include "ext/oracle/least_variance.h"
#include "pbrt/core/counters.h"
#include "pbrt/core/log.h"
#include "pbrt/scene/scene.h"

namespace ext {

namespace {

/// Keeps these random numbers apart from every other use of the seed.
constexpr uint64_t kStream = 0x6f7261636c65ull;

/// Everything the probabilities of a query depend on, to the last bit.
struct QueryKey {
    uint64_t instance = 0;
    Point3 p{};
    Vector3 wo{}, pError{};
    Normal3 n{}, ns{};
    bool transmits = false, hasBsdf = false;
    Float time = 0;
    /// Of the BSDF and the wavelengths, as they lie in memory. Bytes between the members may differ between copies of
    /// one BSDF: then the work is done again, with the same outcome.
    std::array<std::byte, sizeof(Bsdf)> bsdf;
    std::array<std::byte, sizeof(SampledWavelengths)> lambda;

    bool Matches(uint64_t owner, const LightQuery &q) const {
        bool scatters = q.bsdf && q.lambda;
        if (instance != owner || p != q.p || wo != q.wo || pError != q.pError || n != q.n || ns != q.ns ||
            transmits != q.transmits || time != q.time || hasBsdf != scatters)
            return false;
        return !scatters ||
               (std::memcmp(bsdf.data(), static_cast<const void *>(q.bsdf), sizeof(Bsdf)) == 0 &&
                std::memcmp(lambda.data(), static_cast<const void *>(q.lambda), sizeof(SampledWavelengths)) == 0);
    }
    void Set(uint64_t owner, const LightQuery &q) {
        instance = owner;
        p = q.p;
        wo = q.wo;
        pError = q.pError;
        n = q.n;
        ns = q.ns;
        transmits = q.transmits;
        time = q.time;
        hasBsdf = q.bsdf && q.lambda;
        if (!hasBsdf) return;
        std::memcpy(bsdf.data(), static_cast<const void *>(q.bsdf), sizeof(Bsdf));
        std::memcpy(lambda.data(), static_cast<const void *>(q.lambda), sizeof(SampledWavelengths));
    }
};
static_assert(std::is_trivially_copyable_v<Bsdf> && std::is_trivially_copyable_v<SampledWavelengths>);

/// f cos and BSDF sampling's density towards wi.
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

uint64_t NextInstance() {
    static std::atomic<uint64_t> last{0};
    return ++last;
}

Float Fraction(double v) { return std::min(static_cast<Float>(v - std::floor(v)), OneMinusEpsilon); }

}  // namespace

OracleLightSampler::OracleLightSampler(const LightTable &lights, const OracleParams &params)
    : GroupLightSampler(lights, params.meshlights, params.interior),
      params_(params),
      unoccluded_(GroupImportance::EmittersOf(lights, groups_)),
      instance_(NextInstance()) {}

void OracleLightSampler::Prepare(PrepareContext &context) {
    if (groups_.Size() <= 1) return;
    scene_ = &context.scene;
    seed_ = context.seed;
    LogWarning(fmt::format(
        "oracle: a measuring instrument, slow: {} lights x {} samples = up to {} shadow rays at every path vertex.",
        groups_.Size(), params_.samples, groups_.Size() * static_cast<size_t>(params_.samples)));
}

void OracleLightSampler::Measure(const LightQuery &query, std::vector<Float> &cdf) const {
    static const SampledWavelengths middle = SampledWavelengths::SampleVisible(0.5f);
    const SampledWavelengths &lambda = query.bsdf && query.lambda ? *query.lambda : middle;
    const LightSampleContext from{query.p, query.pError, query.n, query.ns, query.time};
    const size_t groupCount = groups_.Size();
    const auto k = static_cast<size_t>(params_.samples);

    thread_local std::vector<LightPoint> points;
    thread_local std::vector<double> pmf;
    points.assign(groupCount * k, LightPoint());
    pmf.assign(groupCount, 0.0);

    RenderCounters &counters = ThreadCounters();
    const RenderCounters before = counters;  // these rays are not the render's
    Rng rng(Hash(kStream, seed_, query.p, query.wo));
    for (uint32_t g = 0; g < groupCount; ++g) {
        const double shift[3] = {static_cast<double>(rng.Uniform()), static_cast<double>(rng.Uniform()),
                                 static_cast<double>(rng.Uniform())};
        for (size_t i = 0; i < k; ++i) {
            // Additive recurrence with the reciprocal powers of the root of x^4 = x + 1: evenly spread for any number.
            const auto at = static_cast<double>(i);
            std::optional<SampledLight> chosen =
                interior_.Sample(g, query, Fraction(shift[0] + at * 0.5497004779019703));
            if (!chosen) continue;
            const Light &light = scene_->Lights()[chosen->light];
            Point2 u(Fraction(shift[1] + at * 0.8191725133961645), Fraction(shift[2] + at * 0.6710436067037893));
            std::optional<LightLiSample> sample = light.SampleLi(from, u, lambda, true);
            if (!sample || !sample->L || !(sample->pdf > 0)) continue;
            const bool findable = params_.mis && !IsDelta(light.Kind());
            Scattered scattered = ScatteredTo(query, sample->wi, findable);
            const Float pLight = chosen->pmf * sample->pdf;
            // Squares are what counts: of the wavelengths as well (emitter.h).
            Float value = RootMeanSquare(sample->L * scattered.fCos) / pLight;
            if (!(value > 0) || !std::isfinite(value) || scene_->Occluded(from, *sample)) continue;
            points[g * k + i] = {value, findable ? scattered.pdf / pLight : 0};
        }
    }
    rays_.fetch_add(counters.shadowRays - before.shadowRays, std::memory_order_relaxed);
    measured_.fetch_add(1, std::memory_order_relaxed);
    counters = before;

    cdf.clear();
    if (!LeastVariancePmf(points, pmf)) return;
    double running = 0;
    size_t last = 0;
    for (size_t g = 0; g < groupCount; ++g) {
        running += pmf[g];
        if (pmf[g] > 0) last = g;
        cdf.push_back(static_cast<Float>(std::min(running, 1.0)));
    }
    std::fill(cdf.begin() + static_cast<std::ptrdiff_t>(last), cdf.end(), Float(1));
}

std::span<const Float> OracleLightSampler::Distribution(const LightQuery &query) const {
    // Sample and PMF of one vertex come one after the other on the same thread: the last answer is enough.
    thread_local QueryKey key;
    thread_local std::vector<Float> cdf;
    if (!key.Matches(instance_, query)) {
        Measure(query, cdf);
        key.Set(instance_, query);
    }
    return cdf;
}

std::optional<GroupLightSampler::ChosenGroup> OracleLightSampler::SampleGroup(const LightQuery &query, Float u) const {
    std::span<const Float> cdf;
    if (scene_) cdf = Distribution(query);
    const Float floor = cdf.empty() ? 1 : params_.floor;
    ChosenGroup chosen;
    if (u < floor) {
        std::optional<SampledLight> g = unoccluded_.Sample(query, std::min(u / floor, OneMinusEpsilon));
        if (!g) return {};
        chosen = {.group = g->light.value, .inner = MeshGroups::InnerNumber(u, query.p)};
    } else {
        chosen = SampleCdf(cdf, query, std::min((u - floor) / (1 - floor), OneMinusEpsilon));
    }
    chosen.pmf = GroupPMF(query, chosen.group);
    return chosen;
}

Float OracleLightSampler::GroupPMF(const LightQuery &query, uint32_t group) const {
    const Float unoccluded = unoccluded_.PMF(query, group);
    std::span<const Float> cdf;
    if (scene_) cdf = Distribution(query);
    return cdf.empty() ? unoccluded : (1 - params_.floor) * CdfPMF(cdf, group) + params_.floor * unoccluded;
}

void OracleLightSampler::Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const {
    size_t seen = 0;
    if (scene_) {
        Float before = 0;
        for (Float c : Distribution(query)) {
            seen += c > before;
            before = c;
        }
    }
    values.push_back({"lights seen", static_cast<double>(seen), false});
}

void OracleLightSampler::Report(nlohmann::ordered_json &report) const {
    const uint64_t measured = measured_, rays = rays_;
    report["parameters"] = EffectiveParams(params_).dump();
    report["note"] = "a measuring instrument: its time says nothing";
    GroupLightSampler::Report(report);
    report["mostShadowRaysPerVertex"] = scene_ ? groups_.Size() * static_cast<size_t>(params_.samples) : 0;
    report["ownShadowRays"] = rays;
    report["ownShadowRaysPerVertex"] = measured ? static_cast<double>(rays) / static_cast<double>(measured) : 0.0;
}

}  // namespace ext
