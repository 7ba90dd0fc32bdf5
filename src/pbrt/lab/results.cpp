#include "pbrt/lab/results.h"

#include <algorithm>
#include <cmath>

#include "pbrt/lab/convergence.h"
#include "pbrt/math/statistics.h"

namespace pbrt::lab {

namespace {

/// Leaves out rounds in which a run took no new sample.
void DropEmptyRounds(RunRecord *run) {
    std::vector<RoundRecord> kept;
    for (const RoundRecord &r : run->rounds)
        if (kept.empty() || r.samples > kept.back().samples) kept.push_back(r);
    run->rounds = std::move(kept);
}

/// Mean over the seeds at every checkpoint that all of them have.
std::vector<CurvePoint> Curve(const SamplerResult &sampler, bool bySamples) {
    std::vector<std::vector<CurvePoint>> curves(sampler.runs.size());
    auto isShared = [&](int checkpoint) {
        return std::all_of(sampler.runs.begin(), sampler.runs.end(), [&](const RunRecord &run) {
            return std::any_of(run.rounds.begin(), run.rounds.end(),
                               [&](const RoundRecord &r) { return r.checkpoint == checkpoint; });
        });
    };
    for (size_t i = 0; i < curves.size(); ++i)
        for (const RoundRecord &r : sampler.runs[i].rounds)
            if (isShared(r.checkpoint))
                curves[i].push_back({bySamples ? double(r.samples) : r.spent.wall, Get(r.measures, Measure::RelL2)});
    return MeanCurve(curves);
}

template <class F>
double MeanOver(const std::vector<RunRecord> &runs, F &&value) {
    double sum = 0;
    for (const RunRecord &run : runs) sum += value(run);
    return runs.empty() ? 0 : sum / static_cast<double>(runs.size());
}

/// CPU seconds of one sample per pixel, over all runs. The first sample of a run warms up caches and cells that are
/// filled on demand.
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

/// Of every run, at its end.
std::vector<double> ErrorsOf(const std::vector<RunRecord> &runs, size_t measure) {
    std::vector<double> errors;
    for (const RunRecord &run : runs) errors.push_back(run.rounds.back().measures[measure]);
    return errors;
}

void SummarizeOne(SamplerResult *s) {
    const auto last = [](const RunRecord &run) -> const RoundRecord & { return run.rounds.back(); };
    s->samples = MeanOver(s->runs, [&](const RunRecord &r) { return double(last(r).samples); });
    s->seconds = MeanOver(s->runs, [&](const RunRecord &r) { return last(r).spent.wall; });
    s->cpuSeconds = MeanOver(s->runs, [&](const RunRecord &r) { return last(r).spent.cpu; });
    s->prepareSeconds = MeanOver(s->runs, [](const RunRecord &r) { return r.prepare.wall; });
    s->prepareCpuSeconds = MeanOver(s->runs, [](const RunRecord &r) { return r.prepare.cpu; });
    for (size_t m = 0; m < MeasureCount; ++m) s->measures[m] = Summarize(ErrorsOf(s->runs, m));
    const double error = s->measures[static_cast<size_t>(Measure::RelL2)].mean;
    s->firefliesDecide = FirefliesDecide(error, s->measures[static_cast<size_t>(Measure::RelL2Trimmed)].mean);
    s->efficiency = Efficiency(error, s->seconds);
    s->cpuPerSample = CpuPerSample(s->runs);
    s->shadowRays = MeanOver(s->runs, [&](const RunRecord &r) { return double(last(r).shadowRays); });
    const double blocked = MeanOver(s->runs, [&](const RunRecord &r) { return double(last(r).shadowRaysBlocked); });
    s->blockedShare = s->shadowRays > 0 ? blocked / s->shadowRays : 0;
}

/// The chance of a false alarm is that of the campaign: one of so many verdicts.
BiasReport JudgeBias(const std::vector<Image> &pictures, const Reference &reference, size_t verdicts) {
    std::vector<TileMeans> runs;
    for (const Image &picture : pictures) runs.push_back(ComputeTileMeans(picture));
    BiasReference judge;
    for (const Image &part : reference.parts) judge.parts.push_back(ComputeTileMeans(part));
    if (judge.parts.empty()) judge.parts.push_back(ComputeTileMeans(reference.image));
    judge.relL2 = reference.noise;
    BiasSettings settings;
    settings.level = SidakLevel(settings.level, verdicts);
    return CheckBias(runs, judge, settings);
}

void CompareSamplers(std::vector<SamplerResult> *samplers) {
    std::vector<ErrorCurve> bySeconds, bySamples;
    for (const SamplerResult &s : *samplers) {
        bySeconds.emplace_back(Curve(s, false), s.prepareSeconds);
        bySamples.emplace_back(Curve(s, true));
    }
    for (size_t i = 0; i < samplers->size(); ++i) {
        SamplerResult &mine = (*samplers)[i];
        const double first = samplers->front().cpuPerSample;
        mine.relativeCost = first > 0 ? mine.cpuPerSample / first : 0;
        for (size_t k = 0; k < samplers->size(); ++k) {
            const SamplerResult &other = (*samplers)[k];
            if (k == i) continue;
            if (other.choice.IsOracle() && !mine.ratioToOracle)
                mine.ratioToOracle = ErrorRatioAtEqualCost(bySamples[i], bySamples[k]);
            const std::optional<ErrorCurve::Reading> speedUp = SpeedUpToEqualError(bySeconds[i], bySeconds[k]);
            if (!speedUp) continue;
            mine.speedUps.emplace_back(other.choice.label, speedUp->value);
            const bool counts = !other.choice.IsOracle() && other.bias.verdict != BiasVerdict::Biased;
            if (counts && (!mine.speedUp || speedUp->value < *mine.speedUp)) {
                mine.speedUp = speedUp->value;
                mine.speedUpAgainst = other.choice.label;
            }
        }
        if (mine.choice.IsOracle()) mine.ratioToOracle = 1;
    }
}

}  // namespace

std::optional<double> ReportNumber(const nlohmann::ordered_json &report, std::initializer_list<const char *> names) {
    for (const char *name : names)
        if (report.contains(name) && report[name].is_number()) return report[name].get<double>();
    return {};
}

CampaignResults Summarize(const CampaignSettings &settings, const References &references,
                          std::vector<std::vector<RunRecord>> runs, const std::vector<std::vector<Image>> &pictures,
                          const std::vector<std::optional<SelectionReport>> &selections) {
    CampaignResults results;
    for (size_t i = 0; i < settings.samplers.size(); ++i) {
        SamplerResult s;
        s.choice = settings.samplers[i];
        s.reference = references.ofSampler[i];
        s.runs = std::move(runs[i]);
        for (RunRecord &run : s.runs) DropEmptyRounds(&run);
        SummarizeOne(&s);
        s.bias = JudgeBias(pictures[i], references.all[s.reference], settings.samplers.size());
        s.selection = selections[i];
        if (s.selection) AddSelection(*s.selection, &s.bias);
        results.samplers.push_back(std::move(s));
    }
    CompareSamplers(&results.samplers);
    std::vector<Contender> contenders;
    for (const SamplerResult &s : results.samplers)
        contenders.push_back({ErrorsOf(s.runs, static_cast<size_t>(Measure::RelL2)),
                              !s.choice.IsOracle() && s.bias.verdict != BiasVerdict::Biased});
    if (std::optional<Winner> winner = FindWinner(contenders)) {
        results.winner = winner->index;
        results.winnerBeyondNoise = winner->beyondNoise;
    }
    return results;
}

}  // namespace pbrt::lab
