#include "pbrt/cmd/pbrt/run_report.h"

#include <fmt/ranges.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "pbrt/core/counters.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/version.h"
#include "pbrt/integrators/direction_sampling.h"

namespace pbrt {

namespace {

/// Adds whatever a sampler or guide reports as attributes.
template <class Reporter>
void AddReport(const Reporter &reporter, const std::string &prefix, ImageMetadata *m) {
    nlohmann::ordered_json report = nlohmann::ordered_json::object();
    reporter.Report(report);
    for (const auto &[key, value] : report.items()) {
        std::string name = prefix + key;
        if (value.is_number_integer())
            m->attributes[name] = value.template get<int>();
        else if (value.is_number())
            m->attributes[name] = value.template get<float>();
        else if (value.is_string())
            m->attributes[name] = value.template get<std::string>();
        else
            m->attributes[name] = value.dump();
    }
}

}  // namespace

double SecondsSinceProcessStart() {
    std::ifstream in("/proc/self/stat");
    std::string text{std::istreambuf_iterator<char>(in), {}};
    // The program's name, in parentheses, may hold blanks. The start is the 20th word after it.
    std::istringstream words(text.substr(text.rfind(')') + 1));
    std::string word;
    for (int i = 0; i < 20; ++i) words >> word;
    timespec now = {};
    if (word.empty() || !words || clock_gettime(CLOCK_BOOTTIME, &now) != 0) return 0;
    const double started = std::strtod(word.c_str(), nullptr) / static_cast<double>(sysconf(_SC_CLK_TCK));
    return std::max(0.0, static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9 - started);
}

ImageMetadata DescribeImage(const CommandLine &options, const BuiltScene &built, const RenderResult &result,
                            const Timings &timings) {
    ImageMetadata m = built.film->Metadata();
    m.attributes["renderTimeSeconds"] = static_cast<float>(result.seconds);
    m.attributes["samplesPerPixel"] = result.samplesTaken;
    if (options.timeBudget > 0) m.attributes["pbrt.plannedSamplesPerPixel"] = built.samplesPerPixel;
    m.attributes["worldToCamera"] = built.cameraFromWorld.Matrix();
    if (std::optional<Transform> ndc = built.camera->NdcFromCamera())
        m.attributes["worldToNDC"] = (*ndc * built.cameraFromWorld).Matrix();
    if (result.mse) m.attributes["MSE"] = static_cast<float>(*result.mse);
    m.attributes["pbrt.commandLine"] = options.text;
    m.attributes["pbrt.scene"] = fmt::format("{}", fmt::join(SceneFilesOf(options), " "));
    m.attributes["pbrt.version"] = std::string(VersionText());
    m.attributes["pbrt.seed"] = built.seed;
    m.attributes["pbrt.integrator"] = built.integratorName;
    m.attributes["pbrt.maxDepth"] = built.maxDepth;
    m.attributes["pbrt.readSeconds"] = static_cast<float>(timings.read);
    m.attributes["pbrt.buildSeconds"] = static_cast<float>(timings.build);
    m.attributes["pbrt.prepareSeconds"] = static_cast<float>(timings.prepare);
    if (!built.leftOut.empty()) m.attributes["pbrt.ignored"] = fmt::format("{}", fmt::join(built.leftOut, "\n"));
    if (result.cancelled) m.attributes["pbrt.interrupted"] = 1;
    if (const LightSampler *lights = built.integrator->Lights()) {
        m.attributes["lightSampler"] = built.lightSamplerName;
        AddReport(*lights, "lightSampler.", &m);
    }
    if (const LightSampler *shooting = built.integrator->ShootingLights()) {
        m.attributes["shootingSampler"] = built.shootingSamplerName;
        AddReport(*shooting, "shootingSampler.", &m);
    }
    if (const DirectionSampling *guide = built.integrator->Directions()) AddReport(*guide, "guide.", &m);
    return m;
}

void PrintStatistics(const BuiltScene &built, const RenderResult &result, const Timings &timings) {
    RenderCounters c = SumCounters();
    auto line = [](const char *what, const std::string &value) { std::printf("  %-34s %s\n", what, value.c_str()); };
    auto share = [](uint64_t part, uint64_t whole) {
        return whole ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0.0;
    };
    std::printf("Statistics\n");
    for (const auto &[phase, seconds] : timings.Phases())
        line((phase + " (s)").c_str(), fmt::format("{:.3f}", seconds));
    line("total (s)", fmt::format("{:.3f}", timings.Total()));
    line("samples per pixel", fmt::format("{}", result.samplesTaken));
    line("shapes, lights", fmt::format("{}, {}", built.scene->ShapeCount(), built.scene->Lights().Size()));
    line("acceleration structure (MB)",
         fmt::format("{:.1f}", static_cast<double>(built.scene->Acceleration().Bytes()) / 1e6));
    line("memory expected before building", built.memory.Text());
    line("camera paths", fmt::format("{}", c.cameraPaths));
    line("path vertices",
         fmt::format("{} ({:.2f} a path)", c.pathVertices,
                     c.cameraPaths ? static_cast<double>(c.pathVertices) / static_cast<double>(c.cameraPaths) : 0.0));
    line("closest-hit rays", fmt::format("{}", c.closestHitRays));
    line("shadow rays", fmt::format("{} ({:.1f} % blocked)", c.shadowRays, share(c.shadowRaysBlocked, c.shadowRays)));
    auto perSecond = [&](uint64_t count) {
        return fmt::format("{:.2f}", static_cast<double>(count) / std::max(1e-9, result.seconds) / 1e6);
    };
    line("rays per second (million)", perSecond(c.closestHitRays + c.shadowRays));
    if (built.scene->HasMedia()) {
        line("look-ups in media", fmt::format("{}", c.mediumLookups));
        line("look-ups per second (million)", perSecond(c.mediumLookups));
    }
    if (built.film->RejectedSamples())
        line("samples dropped (not finite)", fmt::format("{}", built.film->RejectedSamples()));
    auto list = [&](const char *what, const std::string &name, const auto &reporter) {
        nlohmann::ordered_json report = nlohmann::ordered_json::object();
        reporter.Report(report);
        line(what, name);
        for (const auto &[key, value] : report.items())
            line(("  " + key).c_str(), value.is_string() ? value.template get<std::string>() : value.dump());
    };
    if (const LightSampler *lights = built.integrator->Lights()) list("light sampler", built.lightSamplerName, *lights);
    if (const LightSampler *shooting = built.integrator->ShootingLights())
        list("light paths begin by", built.shootingSamplerName, *shooting);
    if (const DirectionSampling *guide = built.integrator->Directions()) list("guide", "", *guide);
}

void PrintStatisticsJson(const CommandLine &options, const BuiltScene &built, const RenderResult &result,
                         const Timings &timings, const std::string &picture) {
    using Json = nlohmann::ordered_json;
    const auto milliseconds = [](double seconds) { return std::round(1000 * seconds) / 1000; };
    const auto bytes = [](double v) { return static_cast<int64_t>(v); };
    const auto report = [](const std::string &name, const auto *reporter) {
        if (!reporter) return Json();
        Json json = Json::object();
        reporter->Report(json);
        return Json{{"name", name}, {"report", json}};
    };
    const RenderCounters c = SumCounters();
    const Bounds2i &window = built.film->PixelBounds();
    const Json json = {
        {"schema", 1},
        {"program", VersionText()},
        {"commandLine", options.text},
        {"scene", SceneFilesOf(options)},
        {"picture", picture.empty() ? Json() : Json(picture)},
        {"resolution", {built.film->FullResolution().x, built.film->FullResolution().y}},
        {"window", {{"x0", window.low.x}, {"x1", window.high.x}, {"y0", window.low.y}, {"y1", window.high.y}}},
        {"integrator", built.integratorName},
        {"maxDepth", built.maxDepth},
        {"seed", built.seed},
        {"threads", ThreadCount()},
        {"samplesPerPixel", result.samplesTaken},
        {"plannedSamplesPerPixel", options.timeBudget > 0 ? Json(built.samplesPerPixel) : Json()},
        {"isInterrupted", result.cancelled},
        {"mse", result.mse ? Json(*result.mse) : Json()},
        {"seconds",
         {{"startUp", milliseconds(timings.startUp)},
          {"reading", milliseconds(timings.read)},
          {"building", milliseconds(timings.build)},
          {"preparingLights", milliseconds(timings.prepare)},
          {"rendering", milliseconds(timings.render)},
          {"writing", milliseconds(timings.write)},
          {"total", milliseconds(timings.Total())}}},
        {"shapes", built.scene->ShapeCount()},
        {"lights", built.scene->Lights().Size()},
        {"bytes",
         {{"expected", bytes(built.memory.Total())},
          {"accelerationStructure", built.scene->Acceleration().Bytes()},
          {"film", built.film->Bytes()}}},
        {"counts",
         {{"cameraPaths", c.cameraPaths},
          {"pathVertices", c.pathVertices},
          {"closestHitRays", c.closestHitRays},
          {"shadowRays", c.shadowRays},
          {"shadowRaysBlocked", c.shadowRaysBlocked},
          {"mediumLookups", c.mediumLookups},
          {"samplesDropped", built.film->RejectedSamples()}}},
        {"lightSampler", report(built.lightSamplerName, built.integrator->Lights())},
        {"shootingSampler", report(built.shootingSamplerName, built.integrator->ShootingLights())},
        {"guide", report("guide", built.integrator->Directions())}};
    std::printf("%s\n", json.dump(1, ' ', false, Json::error_handler_t::replace).c_str());
}

}  // namespace pbrt
