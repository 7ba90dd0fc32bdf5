#include "pbrt/cmd/pbrt/run_report.h"

#include <fmt/ranges.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "pbrt/core/parallel.h"
#include "pbrt/core/version.h"

namespace pbrt {
namespace {

using Json = nlohmann::ordered_json;

struct ComponentReport {
    std::string key, title;  ///< for attributes and JSON; for the user
    std::string name;        ///< empty: only one kind
    Json report = Json::object();
};

std::vector<ComponentReport> ReportsOf(const BuiltScene &built) {
    std::vector<ComponentReport> reports;
    const auto add = [&](const char *key, const char *title, const std::string &name, const auto *reporter) {
        if (reporter) reporter->Report(reports.emplace_back(ComponentReport{key, title, name}).report);
    };
    add("lightSampler", "light sampler", built.lightSamplerName, built.integrator->Lights());
    add("shootingSampler", "light paths begin by", built.shootingSamplerName, built.integrator->EmissionSampler());
    add("guide", "guide", "", built.integrator->Directions());
    return reports;
}

template <class... T>
void PrintLine(const std::string &what, fmt::format_string<T...> value, T &&...arguments) {
    std::printf("  %-34s %s\n", what.c_str(), fmt::format(value, std::forward<T>(arguments)...).c_str());
}

Json AdaptiveJson(const CommandLine &options, const RenderResult &result) {
    if (!result.adaptive) return nullptr;
    const AdaptiveResult &a = *result.adaptive;
    return {{"meanSamples", a.meanSamples},
            {"minSamples", a.minSamples},
            {"maxSamples", a.maxSamples},
            {"decisions", a.decisions},
            {"uniformDecisions", a.uniformDecisions},
            {"predictedGain", a.predictedGain},
            {"noise", a.noise ? Json(*a.noise) : Json()},
            {"noiseRequested", options.noise > 0 ? Json(options.noise) : Json()}};
}

ImageMetadata::Value AttributeOf(const Json &value) {
    if (value.is_number_integer()) return value.get<int>();
    if (value.is_number()) return value.get<float>();
    return value.is_string() ? value.get<std::string>() : value.dump();
}

}  // namespace

double SecondsSinceProcessStart() {
    std::ifstream in("/proc/self/stat");
    std::string text{std::istreambuf_iterator<char>(in), {}};
    // The program name, in parentheses, may contain blanks. The start time is the 20th word after it.
    std::istringstream words(text.substr(text.rfind(')') + 1));
    std::string word;
    for (int i = 0; i < 20; ++i) words >> word;
    if (word.empty() || !words) return 0;
    const double started = std::strtod(word.c_str(), nullptr) / double(sysconf(_SC_CLK_TCK));
    return std::max(0.0, ClockSeconds(CLOCK_BOOTTIME) - started);
}

ImageMetadata DescribeImage(const CommandLine &options, const BuiltScene &built, const RenderResult &result,
                            const Timings &timings) {
    ImageMetadata m = built.film->Metadata();
    m.attributes["renderTimeSeconds"] = float(result.seconds);
    m.attributes["samplesPerPixel"] = result.samplesTaken;
    const Json adaptive = AdaptiveJson(options, result);
    for (const auto &[key, value] : adaptive.items())
        if (!value.is_null()) m.attributes["pbrt." + key] = AttributeOf(value);
    if (options.timeBudget > 0) m.attributes["pbrt.plannedSamplesPerPixel"] = built.samplesPerPixel;
    m.attributes["worldToCamera"] = built.cameraFromWorld.Matrix();
    if (std::optional<Transform> ndc = built.camera->NdcFromCamera())
        m.attributes["worldToNDC"] = (*ndc * built.cameraFromWorld).Matrix();
    if (result.mse) m.attributes["MSE"] = float(*result.mse);
    m.attributes["pbrt.commandLine"] = options.text;
    m.attributes["pbrt.scene"] = fmt::format("{}", fmt::join(options.sceneFiles, " "));
    m.attributes["pbrt.version"] = std::string(VersionText());
    m.attributes["pbrt.seed"] = built.seed;
    m.attributes["pbrt.integrator"] = built.integratorName;
    m.attributes["pbrt.maxDepth"] = built.maxDepth;
    m.attributes["pbrt.readSeconds"] = float(timings.read);
    m.attributes["pbrt.buildSeconds"] = float(timings.build);
    m.attributes["pbrt.prepareSeconds"] = float(timings.prepare);
    if (!built.leftOut.empty()) m.attributes["pbrt.ignored"] = fmt::format("{}", fmt::join(built.leftOut, "\n"));
    if (result.cancelled) m.attributes["pbrt.interrupted"] = 1;
    for (const ComponentReport &r : ReportsOf(built)) {
        if (!r.name.empty()) m.attributes[r.key] = r.name;
        for (const auto &[key, value] : r.report.items()) m.attributes[r.key + "." + key] = AttributeOf(value);
    }
    return m;
}

void PrintStatistics(const BuiltScene &built, const RenderResult &result, const Timings &timings) {
    const RenderCounters c = SumCounters();
    const auto ratio = [](uint64_t part, uint64_t whole) { return whole ? double(part) / double(whole) : 0.0; };
    const auto perSecond = [&](uint64_t count) { return double(count) / std::max(1e-9, timings.render) / 1e6; };
    std::printf("Statistics\n");
    for (const Timings::Phase &p : timings.Phases()) PrintLine(fmt::format("{} (s)", p.name), "{:.3f}", p.seconds);
    PrintLine("total (s)", "{:.3f}", timings.Total());
    PrintLine("samples per pixel", "{}", result.samplesTaken);
    if (const auto &a = result.adaptive) {
        PrintLine("  mean, smallest, largest", "{:.2f}, {}, {}", a->meanSamples, a->minSamples, a->maxSamples);
        PrintLine("  waves planned, uniform, gain", "{}, {}, {:.2f}", a->decisions, a->uniformDecisions,
                  a->predictedGain);
        if (a->noise) PrintLine("noise", "{:.4f}", *a->noise);
    }
    PrintLine("shapes, lights", "{}, {}", built.scene->ShapeCount(), built.scene->Lights().Size());
    PrintLine("acceleration structure (MB)", "{:.1f}", double(built.scene->Acceleration().Bytes()) / 1e6);
    PrintLine("memory expected before building", "{}", built.memory.Text());
    PrintLine("camera paths", "{}", c.cameraPaths);
    PrintLine("path vertices", "{} ({:.2f} a path)", c.pathVertices, ratio(c.pathVertices, c.cameraPaths));
    PrintLine("closest-hit rays", "{}", c.closestHitRays);
    PrintLine("shadow rays", "{} ({:.1f} % blocked)", c.shadowRays, ratio(100 * c.shadowRaysBlocked, c.shadowRays));
    PrintLine("rays per second (million)", "{:.2f}", perSecond(c.closestHitRays + c.shadowRays));
    if (built.scene->HasMedia()) {
        PrintLine("look-ups in media", "{}", c.mediumLookups);
        PrintLine("look-ups per second (million)", "{:.2f}", perSecond(c.mediumLookups));
    }
    if (built.film->RejectedSamples()) PrintLine("samples dropped (not finite)", "{}", built.film->RejectedSamples());
    for (const ComponentReport &r : ReportsOf(built)) {
        PrintLine(r.title, "{}", r.name);
        for (const auto &[key, value] : r.report.items())
            PrintLine("  " + key, "{}", value.is_string() ? value.get<std::string>() : value.dump());
    }
}

void PrintStatisticsJson(const CommandLine &options, const BuiltScene &built, const RenderResult &result,
                         const Timings &timings, const std::string &picture) {
    const auto milliseconds = [](double s) { return std::round(1000 * s) / 1000; };
    Json seconds;
    for (const Timings::Phase &p : timings.Phases()) seconds[p.key] = milliseconds(p.seconds);
    seconds["total"] = milliseconds(timings.Total());
    const RenderCounters c = SumCounters();
    const Bounds2i &window = built.film->PixelBounds();
    Json json = {{"schema", 1},
                 {"program", VersionText()},
                 {"commandLine", options.text},
                 {"scene", options.sceneFiles},
                 {"picture", picture.empty() ? Json() : Json(picture)},
                 {"resolution", {built.film->FullResolution().x, built.film->FullResolution().y}},
                 {"window", {{"x0", window.low.x}, {"x1", window.high.x}, {"y0", window.low.y}, {"y1", window.high.y}}},
                 {"integrator", built.integratorName},
                 {"maxDepth", built.maxDepth},
                 {"seed", built.seed},
                 {"threads", ThreadCount()},
                 {"samplesPerPixel", result.samplesTaken},
                 {"plannedSamplesPerPixel", options.timeBudget > 0 ? Json(built.samplesPerPixel) : Json()},
                 {"adaptive", AdaptiveJson(options, result)},
                 {"isInterrupted", result.cancelled},
                 {"mse", result.mse ? Json(*result.mse) : Json()},
                 {"seconds", seconds},
                 {"shapes", built.scene->ShapeCount()},
                 {"lights", built.scene->Lights().Size()},
                 {"bytes",
                  {{"expected", int64_t(built.memory.Total())},
                   {"accelerationStructure", built.scene->Acceleration().Bytes()},
                   {"film", built.film->Bytes()}}},
                 {"counts",
                  {{"cameraPaths", c.cameraPaths},
                   {"pathVertices", c.pathVertices},
                   {"closestHitRays", c.closestHitRays},
                   {"shadowRays", c.shadowRays},
                   {"shadowRaysBlocked", c.shadowRaysBlocked},
                   {"mediumLookups", c.mediumLookups},
                   {"samplesDropped", built.film->RejectedSamples()}}}};
    for (const char *key : {"lightSampler", "shootingSampler", "guide"}) json[key] = nullptr;
    for (const ComponentReport &r : ReportsOf(built))
        json[r.key] = {{"name", r.name.empty() ? r.key : r.name}, {"report", r.report}};
    std::printf("%s\n", json.dump(1, ' ', false, Json::error_handler_t::replace).c_str());
}

}  // namespace pbrt
