#include "ext/lab/results.h"

#include <algorithm>
#include <cmath>

#include "pbrt/build/light_sampler_spec.h"
#include "pbrt/math/statistics.h"

namespace ext::lab {
namespace {

constexpr double kFewOracleSamples = 8;

/// Mean curve over the seeds, at the checkpoints that all seeds have.
std::vector<CurvePoint> Curve(const SamplerResult &sampler, bool bySamples) {
    std::vector<std::vector<CurvePoint>> curves(sampler.runs.size());
    auto isShared = [&](int checkpoint) {
        return std::ranges::all_of(sampler.runs, [&](const RunRecord &run) {
            return std::ranges::find(run.rounds, checkpoint, &RoundRecord::checkpoint) != run.rounds.end();
        });
    };
    for (size_t i = 0; i < curves.size(); ++i)
        for (const RoundRecord &r : sampler.runs[i].rounds)
            if (isShared(r.checkpoint))
                curves[i].push_back({bySamples ? double(r.samples) : r.spent.wall, Get(r.measures, Measure::RelL2)});
    return MeanCurve(curves);
}

/// CPU seconds per sample per pixel, over all runs. A run's first sample warms up caches and cells filled on demand.
double CpuPerSample(const std::vector<RunRecord> &runs) {
    double cpu = 0, samples = 0;
    for (const RunRecord &run : runs) {
        const RoundRecord &last = run.rounds.back();
        const bool skipFirst = run.rounds.size() > 1;
        cpu += last.spent.cpu - (skipFirst ? run.rounds[0].spent.cpu : run.prepare.cpu);
        samples += last.samples - (skipFirst ? run.rounds[0].samples : 0);
    }
    return samples > 0 ? cpu / samples : 0;
}

std::vector<double> ErrorsOf(const std::vector<RunRecord> &runs, Measure measure) {
    std::vector<double> errors;
    for (const RunRecord &run : runs) errors.push_back(Get(run.rounds.back().measures, measure));
    return errors;
}

/// Number in a LightSampler::Report.
std::optional<double> ReportNumber(const Json &report, const char *name) {
    if (!report.contains(name) || !report[name].is_number()) return {};
    return report[name].get<double>();
}

/// Null unless all runs report it.
Json ReportMean(const SamplerResult &s, const char *name) {
    double sum = 0;
    for (const RunRecord &run : s.runs) {
        const std::optional<double> value = ReportNumber(run.report, name);
        if (!value) return {};
        sum += *value;
    }
    return sum / double(s.runs.size());
}

double PrepassSeconds(const RunRecord &run) { return ReportNumber(run.report, "prepassSeconds").value_or(0); }

void SummarizeOne(SamplerResult *s) {
    const auto mean = [&](auto &&value) {
        double sum = 0;
        for (const RunRecord &run : s->runs) sum += value(run);
        return sum / double(s->runs.size());
    };
    s->samples = mean([](const RunRecord &r) { return double(r.rounds.back().samples); });
    s->prepareSeconds = mean([](const RunRecord &r) { return r.prepare.wall; });
    s->cpuPerSample = CpuPerSample(s->runs);
    for (size_t m = 0; m < MeasureCount; ++m) s->measures[m] = Summarize(ErrorsOf(s->runs, static_cast<Measure>(m)));
    const double error = Get(s->measures, Measure::RelL2).mean;
    s->firefliesDecide = FirefliesDecide(error, Get(s->measures, Measure::RelL2Trimmed).mean);

    const double seconds = mean([](const RunRecord &r) { return r.rounds.back().spent.wall; });
    const double cpuSeconds = mean([](const RunRecord &r) { return r.rounds.back().spent.cpu; });
    const double shadowRays = mean([](const RunRecord &r) { return double(r.rounds.back().shadowRays); });
    const double blocked = mean([](const RunRecord &r) { return double(r.rounds.back().shadowRaysBlocked); });
    Json &json = s->summary;
    json["samples"] = s->samples;
    json["seconds"] = seconds;
    json["cpuSeconds"] = cpuSeconds;
    for (size_t m = 0; m < MeasureCount; ++m)
        json["metrics"][MeasureNames[m]] = {{"mean", s->measures[m].mean},
                                            {"stdDev", s->measures[m].stdDev},
                                            {"standardError", s->measures[m].standardError}};
    json["firefliesDecide"] = s->firefliesDecide;
    json["efficiency"] = Efficiency(error, seconds);
    // Preparation not reported as prepass counts as building.
    json["overhead"] = {
        {"prepassSeconds", mean(PrepassSeconds)},
        {"buildSeconds", mean([](const RunRecord &r) { return std::max(0.0, r.prepare.wall - PrepassSeconds(r)); })},
        {"renderSeconds", mean([](const RunRecord &r) { return r.rounds.back().spent.wall - r.prepare.wall; })}};
    json["cpuSecondsPerSample"] = s->cpuPerSample;
    json["preparationShare"] = cpuSeconds > 0 ? mean([](const RunRecord &r) { return r.prepare.cpu; }) / cpuSeconds : 0;
    json["leaves"] = ReportMean(*s, "leaves");
    json["bytes"] = ReportMean(*s, "bytes");
    json["shadowRays"] = shadowRays;
    json["blockedShare"] = shadowRays > 0 ? blocked / shadowRays : 0;
}

Json BiasJson(const BiasReport &b) {
    auto finite = [](double v) { return std::isfinite(v) ? Json(v) : Json(); };
    return {{"verdict", BiasVerdictName(b.verdict)},
            {"tiles", b.tiles},
            {"tests", b.tests},
            {"worstZ", finite(b.worstZ)},
            {"pValue", b.pValue},
            {"meanDifference", finite(b.meanDifference)},
            {"visibleImage", finite(b.visibleImage)},
            {"visibleSixteenth", finite(b.visibleSixteenth)},
            {"visibleSmallest", finite(b.visibleSmallest)},
            {"smallestSide", b.smallestSide},
            {"text", b.text}};
}

/// Sets `bias` of the samplers, which have the samples of their runs and are in the order of `pictures`.
void JudgeImages(const References &references, const std::vector<std::vector<Image>> &pictures,
                 std::vector<SamplerResult> &samplers) {
    struct Source {
        std::string name;
        std::vector<TileMeans> tiles;
        double samples = 0;  ///< per pixel of one image; 0: unknown
    };
    std::vector<Source> sources;  // the samplers, then the references; with and without +mesh auxiliary to each other
    for (size_t i = 0; i < samplers.size(); ++i)
        sources.push_back({WithoutMesh(samplers[i].choice.label), TilesOf(pictures[i]), samplers[i].samples});
    for (const Reference &r : references.all) {
        Source &source = sources.emplace_back(Source{WithoutMesh(r.sampler), TilesOf(r.parts)});
        if (r.parts.empty()) source.tiles.push_back(ComputeTileMeans(r.image));
        source.samples = r.samples / double(source.tiles.size());
    }
    // The level is the false alarm probability of the whole experiment, which has one verdict per sampler.
    BiasSettings settings;
    settings.level = SidakLevel(settings.level, samplers.size());
    for (size_t i = 0; i < samplers.size(); ++i) {
        SamplerResult &s = samplers[i];
        const Source &runs = sources[i], &judge = sources[samplers.size() + s.reference];
        auto ratio = [&](const Source &p) { return p.samples > 0 && runs.samples > 0 ? p.samples / runs.samples : 1; };
        auto auxiliaryOf = [&](const std::string &name) {
            std::vector<AuxiliaryRuns> auxiliary;
            for (const Source &p : sources)
                if (&p != &runs && &p != &judge && !name.empty() && p.name == name)
                    auxiliary.push_back({p.tiles, ratio(p)});
            return auxiliary;
        };
        const BiasReference reference{judge.tiles, references.all[s.reference].noise, ratio(judge),
                                      auxiliaryOf(judge.name)};
        s.bias = CheckBias(runs.tiles, reference, settings, auxiliaryOf(runs.name));
    }
}

Json OrNull(const std::optional<double> &value) { return value ? Json(*value) : Json(); }

void CompareSamplers(std::vector<SamplerResult> &samplers) {
    std::vector<ErrorCurve> bySeconds, bySamples;
    for (const SamplerResult &s : samplers) {
        bySeconds.emplace_back(Curve(s, false), s.prepareSeconds);
        bySamples.emplace_back(Curve(s, true));
    }
    const double first = samplers.front().cpuPerSample;
    const size_t oracle =
        std::ranges::find_if(samplers, [](const auto &s) { return s.choice.traits.isInstrument; }) - samplers.begin();
    for (size_t i = 0; i < samplers.size(); ++i) {
        SamplerResult &mine = samplers[i];
        Json speedUps = Json::object();
        for (size_t k = 0; k < samplers.size(); ++k) {
            const SamplerResult &other = samplers[k];
            if (k == i) continue;
            const std::optional<double> speedUp = SpeedUpToEqualError(bySeconds[i], bySeconds[k]);
            if (!speedUp) continue;
            speedUps[other.choice.label] = *speedUp;
            const bool counts = !other.choice.traits.isInstrument && other.bias.verdict != BiasVerdict::Biased;
            if (counts && (!mine.speedUp || *speedUp < *mine.speedUp)) {
                mine.speedUp = *speedUp;
                mine.speedUpAgainst = other.choice.label;
            }
        }
        mine.summary["speedUp"] = OrNull(mine.speedUp);
        mine.summary["speedUpAgainst"] = mine.speedUp ? Json(mine.speedUpAgainst) : Json();
        mine.summary["speedUps"] = speedUps;
        mine.summary["ratioToOracle"] =
            oracle < samplers.size() ? OrNull(ErrorRatioAtEqualCost(bySamples[i], bySamples[oracle])) : Json();
        mine.summary["relativeCost"] = first > 0 ? mine.cpuPerSample / first : 0;
    }
}

std::vector<std::string> RemarksOn(const ExperimentSettings &settings, const References &references,
                                   const std::vector<SamplerResult> &samplers) {
    std::vector<std::string> remarks = references.remarks;
    for (const SamplerResult &s : samplers)
        if (s.choice.traits.isInstrument && s.samples < kFewOracleSamples)
            remarks.push_back(fmt::format("\"{}\" took only {:.1f} samples per pixel, so ratios to it are rough; {}.",
                                          s.choice.label, s.samples,
                                          settings.Timed() ? "--spp gives equal samples" : "use more --spp"));
    if (settings.sampledLightOnly)
        remarks.emplace_back(
            "--sampled-light: the images lack lights seen directly or by specular reflection, and caustics.");
    return remarks;
}

}  // namespace

ExperimentResults Summarize(const ExperimentSettings &settings, const References &references,
                            std::vector<std::vector<RunRecord>> runs, const std::vector<std::vector<Image>> &pictures,
                            const std::vector<std::optional<SelectionReport>> &selections) {
    ExperimentResults results;
    for (size_t i = 0; i < settings.samplers.size(); ++i) {
        SamplerResult s;
        s.choice = settings.samplers[i];
        s.reference = references.ofSampler[i];
        s.runs = std::move(runs[i]);
        for (RunRecord &run : s.runs) {
            const auto empty = std::ranges::unique(run.rounds, {}, &RoundRecord::samples);
            run.rounds.erase(empty.begin(), empty.end());
        }
        SummarizeOne(&s);
        s.selection = selections[i];
        results.samplers.push_back(std::move(s));
    }
    JudgeImages(references, pictures, results.samplers);
    for (SamplerResult &s : results.samplers) {
        if (references.areDoubtful && s.bias.verdict == BiasVerdict::Biased) {
            s.bias.verdict = BiasVerdict::Unknown;
            s.bias.text += " The references contradict each other, so bias is unknown.";
        }
        if (s.selection) AddSelection(*s.selection, &s.bias);
        s.summary["bias"] = BiasJson(s.bias);
        if (s.selection) s.summary["bias"]["selection"] = ToJson(*s.selection);
    }
    CompareSamplers(results.samplers);
    for (const SamplerResult &s : results.samplers)
        results.contenders.push_back({s.choice.label, ErrorsOf(s.runs, Measure::RelL2),
                                      ErrorsOf(s.runs, Measure::RelL2Trimmed), s.bias.verdict,
                                      s.choice.traits.isInstrument, s.firefliesDecide, s.speedUp, s.speedUpAgainst});
    results.conclusion = Conclude(results.contenders, references.doubts,
                                  RemarksOn(settings, references, results.samplers), settings.Timed());
    return results;
}

}  // namespace ext::lab
