#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "ext/lab/results.h"
#include "pbrt/core/error.h"

namespace ext::lab {
namespace {

Json ParametersOf(const RunRecord &run) {
    if (!run.report.contains("parameters")) return Json::object();
    Json p = run.report["parameters"];
    if (p.is_string()) p = Json::parse(p.get<std::string>(), nullptr, false);
    return p.is_object() ? p : run.report["parameters"];
}

Json RunJson(const SamplerResult &s, const RunRecord &run) {
    Json rounds = Json::array();
    for (const RoundRecord &r : run.rounds)
        rounds.push_back({{"checkpoint", r.checkpoint},
                          {"samples", r.samples},
                          {"seconds", r.spent.wall},
                          {"cpuSeconds", r.spent.cpu},
                          {"metrics", ToJson(r.measures)}});
    return {{"seed", run.seed},
            {"image", fmt::format("{}/seed{}.exr", s.choice.folder, run.seed)},
            {"expectedSamples", run.expectedSamples},
            {"prepareSeconds", run.prepare.wall},
            {"prepareCpuSeconds", run.prepare.cpu},
            {"prepareShadowRays", run.prepareShadowRays},
            {"shadowRays", run.rounds.back().shadowRays},
            {"shadowRaysBlocked", run.rounds.back().shadowRaysBlocked},
            {"rounds", rounds}};
}

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
        entry["isOracle"] = s.choice.traits.isInstrument;
        entry["reference"] = s.reference;
        entry["report"] = report;
        entry["structure"] = first.structure;
        entry["picture"] = s.choice.folder + "/result.png";
        entry["pictureRange"] = s.choice.folder + "/result.hdr";
        entry["errorPicture"] = s.choice.folder + "/error.png";
        entry["runs"] = Json::array();
        for (const RunRecord &run : s.runs) entry["runs"].push_back(RunJson(s, run));
        entry["summary"] = s.summary;
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
        std::vector<std::string> fields = {Quoted(s.choice.label)};
        const auto add = [&](std::initializer_list<const char *> pointers) {
            for (const char *pointer : pointers) {
                const Json &value = s.summary.at(Json::json_pointer(pointer));
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
    std::string text =
        fmt::format("sampler,seed,checkpoint,samples,seconds,cpuSeconds,shadowRays,shadowRaysBlocked,{}\n",
                    fmt::join(MeasureNames, ","));
    for (const SamplerResult &s : results.samplers)
        for (const RunRecord &run : s.runs)
            for (const RoundRecord &r : run.rounds)
                text += fmt::format("{},{},{},{},{:.6f},{:.6f},{},{},{:.9g}\n", Quoted(s.choice.label), run.seed,
                                    r.checkpoint, r.samples, r.spent.wall, r.spent.cpu, r.shadowRays,
                                    r.shadowRaysBlocked, fmt::join(r.measures, ","));
    return text;
}

std::string TableText(const ExperimentResults &results, const References &references) {
    auto optional = [](const Json &v, const char *unit) {
        return v.is_number() ? fmt::format("{:.2f}{}", v.get<double>(), unit) : std::string("-");
    };
    std::vector<std::vector<std::string>> rows = {{"sampler", "samples", "seconds", "relL2", "+-", "trimmed",
                                                   "efficiency", "speed-up", "x oracle", "prepass s", "build s",
                                                   "prep.", "cost", "blocked", "bias"}};
    for (const SamplerResult &s : results.samplers) {
        const Json &summary = s.summary, &overhead = summary.at("overhead");
        auto percent = [](const Json &v) { return fmt::format("{:.1f} %", 100 * v.get<double>()); };
        auto thousandths = [](const Json &v) { return fmt::format("{:.3f}", v.get<double>()); };
        rows.push_back(
            {s.choice.label, fmt::format("{:.1f}", s.samples), optional(summary.at("seconds"), ""),
             fmt::format("{:.4g}", Get(s.measures, Measure::RelL2).mean),
             s.runs.size() > 1 ? fmt::format("{:.2g}", Get(s.measures, Measure::RelL2).standardError) : "-",
             fmt::format("{:.4g}{}", Get(s.measures, Measure::RelL2Trimmed).mean, s.firefliesDecide ? " !" : ""),
             fmt::format("{:.4g}", summary.at("efficiency").get<double>()), optional(summary.at("speedUp"), "x"),
             optional(summary.at("ratioToOracle"), ""), thousandths(overhead.at("prepassSeconds")),
             thousandths(overhead.at("buildSeconds")), percent(summary.at("preparationShare")),
             thousandths(summary.at("relativeCost")), percent(summary.at("blockedShare")),
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
