#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "ext/lab/measures.h"
#include "ext/lab/results.h"
#include "ext/lab/text_output.h"
#include "pbrt/core/error.h"

namespace ext::lab {
namespace {

/// Number in a LightSampler::Report.
std::optional<double> ReportNumber(const Json &report, const char *name) {
    if (!report.contains(name) || !report[name].is_number()) return {};
    return report[name].get<double>();
}

struct Overhead {
    double prepass = 0, build = 0, render = 0;  ///< seconds, means over the runs
};

Overhead OverheadOf(const SamplerResult &s) {
    Overhead o;
    for (const RunRecord &run : s.runs) {
        const double prepass = ReportNumber(run.report, "prepassSeconds").value_or(0);
        o.prepass += prepass;
        // Preparation not reported as prepass counts as building.
        o.build += std::max(0.0, run.prepare.wall - prepass);
        o.render += run.rounds.back().spent.wall - run.prepare.wall;
    }
    const double n = double(std::max<size_t>(1, s.runs.size()));
    return {o.prepass / n, o.build / n, o.render / n};
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

Json OrNull(const std::optional<double> &value) { return value ? Json(*value) : Json(); }

Json ParametersOf(const RunRecord &run) {
    if (!run.report.contains("parameters")) return Json::object();
    Json p = run.report["parameters"];
    if (p.is_string()) p = Json::parse(p.get<std::string>(), nullptr, false);
    return p.is_object() ? p : run.report["parameters"];
}

Json RunJson(const SamplerResult &s, const RunRecord &run) {
    Json json;
    json["seed"] = run.seed;
    json["image"] = fmt::format("{}/seed{}.exr", s.choice.folder, run.seed);
    json["expectedSamples"] = run.expectedSamples;
    json["prepareSeconds"] = run.prepare.wall;
    json["prepareCpuSeconds"] = run.prepare.cpu;
    json["prepareShadowRays"] = run.prepareShadowRays;
    json["shadowRays"] = run.rounds.back().shadowRays;
    json["shadowRaysBlocked"] = run.rounds.back().shadowRaysBlocked;
    json["rounds"] = Json::array();
    for (const RoundRecord &r : run.rounds)
        json["rounds"].push_back({{"checkpoint", r.checkpoint},
                                  {"samples", r.samples},
                                  {"seconds", r.spent.wall},
                                  {"cpuSeconds", r.spent.cpu},
                                  {"metrics", ToJson(r.measures)}});
    return json;
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

Json SummaryJson(const SamplerResult &s) {
    Json json;
    json["samples"] = s.samples;
    json["seconds"] = s.seconds;
    json["cpuSeconds"] = s.cpuSeconds;
    for (size_t m = 0; m < MeasureCount; ++m)
        json["metrics"][MeasureNames[m]] = {{"mean", s.measures[m].mean},
                                            {"stdDev", s.measures[m].stdDev},
                                            {"standardError", s.measures[m].standardError}};
    json["firefliesDecide"] = s.firefliesDecide;
    json["efficiency"] = s.efficiency;
    json["speedUp"] = OrNull(s.speedUp);
    json["speedUpAgainst"] = s.speedUp ? Json(s.speedUpAgainst) : Json();
    json["speedUps"] = Json::object();
    for (const auto &[label, value] : s.speedUps) json["speedUps"][label] = value;
    json["ratioToOracle"] = OrNull(s.ratioToOracle);
    const Overhead o = OverheadOf(s);
    json["overhead"] = {{"prepassSeconds", o.prepass}, {"buildSeconds", o.build}, {"renderSeconds", o.render}};
    json["cpuSecondsPerSample"] = s.cpuPerSample;
    json["relativeCost"] = s.relativeCost;
    json["preparationShare"] = s.cpuSeconds > 0 ? s.prepareCpuSeconds / s.cpuSeconds : 0;
    json["leaves"] = ReportMean(s, "leaves");
    json["bytes"] = ReportMean(s, "bytes");
    json["shadowRays"] = s.shadowRays;
    json["blockedShare"] = s.blockedShare;
    json["bias"] = BiasJson(s.bias);
    if (s.selection) json["bias"]["selection"] = ToJson(*s.selection);
    return json;
}

std::string PercentWithTenths(double share) { return fmt::format("{:.1f} %", 100 * share); }

}  // namespace

void ShortenFloats(Json *json) {
    if (json->is_structured()) {
        for (auto &entry : json->items()) ShortenFloats(&entry.value());
    } else if (json->is_number_float()) {
        const double value = json->get<double>();
        const auto single = float(value);
        if (std::isfinite(single) && double(single) == value) *json = std::stod(fmt::format("{}", single));
    }
}

void AddToJson(const ExperimentResults &results, Json *json) {
    (*json)["samplers"] = Json::array();
    for (const SamplerResult &s : results.samplers) {
        Json entry;
        const RunRecord &first = s.runs.front();
        entry["label"] = s.choice.label;
        entry["lightSampler"] = s.choice.name;
        entry["parameters"] = ParametersOf(first);
        Json report = first.report;
        report.erase("parameters");
        entry["meshLights"] = s.choice.meshLights;
        entry["isOracle"] = s.choice.IsOracle();
        entry["reference"] = s.reference;
        entry["report"] = report;
        entry["structure"] = first.structure;
        entry["picture"] = s.choice.folder + "/result.png";
        entry["pictureRange"] = s.choice.folder + "/result.hdr";
        entry["errorPicture"] = s.choice.folder + "/error.png";
        entry["runs"] = Json::array();
        for (const RunRecord &run : s.runs) entry["runs"].push_back(RunJson(s, run));
        entry["summary"] = SummaryJson(s);
        (*json)["samplers"].push_back(std::move(entry));
    }
    (*json)["conclusion"] = ToJson(results.conclusion, results.contenders);
}

std::string SummaryCsv(const ExperimentResults &results) {
    std::string text = "sampler,samples,seconds,cpuSeconds";
    for (const char *name : MeasureNames) text += fmt::format(",{0},{0}StandardError", name);
    text +=
        ",efficiency,speedUp,speedUpAgainst,ratioToOracle,prepassSeconds,buildSeconds,renderSeconds,preparationShare,cpuSecondsPerSample,relativeCost,leaves,bytes,shadowRays,blockedShare,biasVerdict,biasPValue\n";
    for (const SamplerResult &s : results.samplers) {
        const Json summary = SummaryJson(s);
        std::vector<std::string> fields = {Quoted(s.choice.label)};
        const auto add = [&](std::initializer_list<const char *> pointers) {
            for (const char *pointer : pointers) {
                const Json &value = summary.at(Json::json_pointer(pointer));
                fields.push_back(value.is_number()   ? fmt::format("{:.9g}", value.get<double>())
                                 : value.is_string() ? Quoted(value.get<std::string>())
                                                     : std::string());
            }
        };
        add({"/samples", "/seconds", "/cpuSeconds"});
        for (const Summary &m : s.measures) {
            fields.push_back(fmt::format("{:.9g}", m.mean));
            fields.push_back(m.count > 1 ? fmt::format("{:.9g}", m.standardError) : std::string());
        }
        add({"/efficiency", "/speedUp", "/speedUpAgainst", "/ratioToOracle", "/overhead/prepassSeconds",
             "/overhead/buildSeconds", "/overhead/renderSeconds", "/preparationShare", "/cpuSecondsPerSample",
             "/relativeCost", "/leaves", "/bytes", "/shadowRays", "/blockedShare", "/bias/verdict", "/bias/pValue"});
        text += fmt::format("{}\n", fmt::join(fields, ","));
    }
    return text;
}

std::string RoundsCsv(const ExperimentResults &results) {
    std::string text = "sampler,seed,checkpoint,samples,seconds,cpuSeconds,shadowRays,shadowRaysBlocked";
    for (const char *name : MeasureNames) text += std::string(",") + name;
    text += "\n";
    for (const SamplerResult &s : results.samplers)
        for (const RunRecord &run : s.runs)
            for (const RoundRecord &r : run.rounds) {
                text += fmt::format("{},{},{},{},{:.6f},{:.6f},{},{}", Quoted(s.choice.label), run.seed, r.checkpoint,
                                    r.samples, r.spent.wall, r.spent.cpu, r.shadowRays, r.shadowRaysBlocked);
                for (double m : r.measures) text += fmt::format(",{:.9g}", m);
                text += "\n";
            }
    return text;
}

std::string TableText(const ExperimentResults &results, const References &references) {
    auto optional = [](const std::optional<double> &v, const char *unit) {
        return v ? fmt::format("{:.2f}{}", *v, unit) : std::string("-");
    };
    std::vector<std::vector<std::string>> rows = {{"sampler", "samples", "seconds", "relL2", "+-", "trimmed",
                                                   "efficiency", "speed-up", "x oracle", "prepass s", "build s",
                                                   "prep.", "cost", "blocked", "bias"}};
    for (const SamplerResult &s : results.samplers) {
        const Overhead o = OverheadOf(s);
        rows.push_back(
            {s.choice.label, fmt::format("{:.1f}", s.samples), fmt::format("{:.2f}", s.seconds),
             fmt::format("{:.4g}", Get(s.measures, Measure::RelL2).mean),
             fmt::format("{:.2g}", Get(s.measures, Measure::RelL2).standardError),
             fmt::format("{:.4g}{}", Get(s.measures, Measure::RelL2Trimmed).mean, s.firefliesDecide ? " !" : ""),
             fmt::format("{:.4g}", s.efficiency), optional(s.speedUp, "x"), optional(s.ratioToOracle, ""),
             fmt::format("{:.3f}", o.prepass), fmt::format("{:.3f}", o.build),
             PercentWithTenths(s.cpuSeconds > 0 ? s.prepareCpuSeconds / s.cpuSeconds : 0),
             fmt::format("{:.3f}", s.relativeCost), PercentWithTenths(s.blockedShare),
             BiasVerdictName(s.bias.verdict)});
    }
    std::string text = Align(rows);
    text +=
        "\nspeed-up: time that the best other sampler needs for this one's error, over this one's time. x oracle: "
        "relL2 over the oracle's at equal samples.\ncost: CPU time of a sample over that of the first sampler. prep.: "
        "share of the preparation in the CPU time. !: a few fireflies decide the relL2.\n";
    for (size_t i = 0; i < references.all.size(); ++i) {
        const Reference &r = references.all[i];
        text += fmt::format("reference {}: {}{}{} ({})\n", i, r.sampler.empty() ? "given" : r.sampler,
                            r.samples ? fmt::format(", {} per pixel", CountText(r.samples, "sample")) : "",
                            r.noise ? fmt::format(", relL2 of its own noise {:.3g}", *r.noise) : "", r.source);
    }
    text += "\n";
    for (const SamplerResult &s : results.samplers)
        text += fmt::format("{}: {}. {}\n", s.choice.label, BiasVerdictName(s.bias.verdict), s.bias.text);
    text += fmt::format("\n{}\n", fmt::join(results.conclusion.Sentences(), "\n"));
    return text;
}

}  // namespace ext::lab
