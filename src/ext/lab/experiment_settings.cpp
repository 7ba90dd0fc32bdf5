#include "ext/lab/experiment_settings.h"

#include <boost/algorithm/string/trim.hpp>
#include <cctype>
#include <set>
#include <sstream>
#include <utility>

#include "pbrt/build/integrator_builder.h"
#include "pbrt/core/log.h"
#include "pbrt/core/version.h"
#include "pbrt/scenefile/content_hash.h"
#include "pbrt/scenefile/parser.h"

namespace ext::lab {

std::string SafeFileName(std::string text, std::string_view kept) {
    for (char &c : text)
        if (!std::isalnum(static_cast<unsigned char>(c)) && kept.find(c) == kept.npos) c = '_';
    return text;
}

std::vector<std::string> SplitSamplerList(const std::string &text) {
    std::vector<std::string> list;
    std::istringstream groups(text);
    for (std::string group; std::getline(groups, group, ';');) {
        const size_t first = list.size();
        std::istringstream in(group);
        for (std::string piece; std::getline(in, piece, ',');) {
            size_t stop = piece.find_first_of("=:+");
            if (stop != std::string::npos && piece[stop] == '=' && list.size() > first)
                list.back().append(",").append(boost::trim_copy(piece));
            else list.push_back(boost::trim_copy(piece));
        }
    }
    return list;
}

std::vector<std::string> ReadSamplerFile(const std::string &path) {
    std::vector<std::string> list;
    std::istringstream in(ReadFileContents(path));
    for (std::string line; std::getline(in, line);)
        if (std::string sampler = boost::trim_copy(line.substr(0, line.find('#'))); !sampler.empty())
            list.push_back(sampler);
    if (list.empty()) throw UserError("{}: names no light sampler.", path);
    return list;
}

std::vector<SamplerChoice> ParseSamplerChoices(const std::vector<std::string> &texts, const PluginRegistry &registry) {
    DiagnosticSink sink;
    std::vector<SamplerChoice> choices;
    std::set<std::string> labels, folders;
    if (texts.empty()) sink.Error({}, "no light sampler is named.");
    for (const std::string &text : texts)
        Collect(sink, [&] {
            if (text.empty()) throw UserError("the list of samplers has an empty entry.");
            LightFlags flags;
            flags.choice = text;
            flags.choiceFlag = kSamplersFlag;
            const std::optional<LightSelection> selection = ReadLightSelection(ParamSet(), flags, registry, sink);
            if (!selection) return;
            const auto &entry = *selection->sampler.entry;
            SamplerChoice choice{text, SafeFileName(text), entry.name, WithoutMesh(text) != text, entry.traits};
            if (!labels.insert(text).second) throw UserError("sampler \"{}\" is listed twice.", text);
            while (!folders.insert(choice.folder).second) choice.folder += "_";
            choices.push_back(choice);
        });
    sink.ThrowIfErrors();
    for (const Diagnostic &warning : sink.All()) LogInfo(Format(warning));
    return choices;
}

Json IdentityOf(const ExperimentSettings &settings, const std::string &sceneHash, int threads) {
    Json id;
    id["scene"] = sceneHash;
    id["program"] = VersionText();
    id["samplers"] = Json::array();
    for (const SamplerChoice &s : settings.samplers) id["samplers"].push_back(s.label);
    if (settings.Timed()) id["time"] = settings.timeBudget;
    else id["spp"] = settings.samplesPerPixel;
    id["seeds"] = settings.seeds;
    id["maxdepth"] = settings.maxDepth ? Json(*settings.maxDepth) : Json("the scene's");
    if (settings.sampledLightOnly) id["sampled-light"] = true;
    id["divisor"] = settings.resolutionDivisor;
    id["reference"] = settings.referenceFile;
    if (!settings.referenceFile.empty())
        id["reference-content"] = ContentHash(ReadFileContents(settings.referenceFile)).Hex();
    id["reference-spp"] = settings.referenceSamples;
    id["samples-from"] = settings.samplesFrom.empty() ? "" : SampleCounts::Read(settings.samplesFrom, settings).hash;
    id["threads"] = threads;
    return id;
}

std::string ExperimentKey(Json identity) {
    identity.erase("seeds");
    return ContentHash("records 2 " + identity.dump()).Hex();
}

std::vector<std::string> Differences(const Json &old, const Json &now) {
    std::vector<std::string> list;
    auto text = [](const Json &json, const std::string &key) {
        return json.contains(key) ? json[key].dump() : std::string("nothing");
    };
    Json keys = old;
    keys.update(now);
    keys.erase("seeds");  // runs are independent: a resumed experiment may change the number of seeds
    for (const auto &[key, value] : keys.items())
        if (!old.contains(key) || !now.contains(key) || old[key] != now[key])
            list.push_back(fmt::format("{}: was {}, now {}", key, text(old, key), text(now, key)));
    return list;
}

Json ReadResults(const std::string &path) {
    Json json = Json::parse(ReadFileContents(path), nullptr, false);
    if (!json.is_object() || (json.value("schema", 0) != 1 && json.value("schema", 0) != kResultsSchema) ||
        !json.contains("samplers") || !json.contains("settings"))
        throw UserError("{}: is not a results.json of lightlab.", path);
    return json;
}

SampleCounts SampleCounts::Read(const std::string &path, const ExperimentSettings &settings) {
    const Json results = ReadResults(path);
    SampleCounts read;
    ContentHash hash;
    try {
        read.checkpoints = results.at("settings").at("checkpoints").get<int>();
        for (const Json &sampler : results.at("samplers"))
            for (const Json &run : sampler.at("runs")) {
                const std::string label = sampler.at("label");
                std::vector<int> &counts = read.runs[{label, run.at("seed").get<int>()}];
                counts.assign(read.checkpoints, 0);
                for (const Json &round : run.at("rounds"))
                    counts.at(round.at("checkpoint").get<size_t>()) = round.at("samples").get<int>();
                for (size_t i = 1; i < counts.size(); ++i) counts[i] = std::max(counts[i], counts[i - 1]);
                const int expected = read.expected[label] = run.at("expectedSamples").get<int>();
                hash.Add(fmt::format("{} {}", expected, Json(counts).dump()));
            }
    } catch (const std::exception &) {
        throw UserError("{}: the sample counts cannot be read.", path);
    }
    for (const SamplerChoice &s : settings.samplers)
        for (int seed = 0; seed < settings.seeds; ++seed)
            if (!read.runs.contains({s.label, seed}))
                throw UserError("{}: has no run of sampler \"{}\" with seed {}.", path, s.label, seed);
    read.hash = hash.Hex();
    return read;
}

ImageMetadata LabScene::Metadata(const Film &film, const std::string &sampler, int samples, double seconds) const {
    ImageMetadata m = film.Metadata();
    m.attributes["lightlab.sampler"] = sampler;
    m.attributes["lightlab.sceneHash"] = hash;
    m.attributes["lightlab.sampledLight"] = int(built.integratorRequest.options.sampledLightOnly);
    m.attributes["samplesPerPixel"] = samples;
    m.attributes["renderTimeSeconds"] = float(seconds);
    m.attributes["pbrt.version"] = std::string(VersionText());
    m.attributes["pbrt.integrator"] = built.integratorName;
    m.attributes["pbrt.maxDepth"] = built.maxDepth;
    return m;
}

std::unique_ptr<Integrator> LabScene::MakeIntegrator(const SamplerChoice &choice, std::optional<int> maxDepth) const {
    return pbrt::MakeIntegrator(built, {choice.label, false, maxDepth}).integrator;
}

BuiltScene BuildLitScene(SceneDescription &description, const std::string &file, const BuildOptions &options,
                         const PluginRegistry &registry, DiagnosticSink &sink, Progress &progress) {
    sink.ThrowIfErrors();
    const std::string &integrator = description.integrator.type;
    if (Integrators().Has(integrator) && !TraitsOf(integrator).hasLightSampler)
        throw UserError(description.integrator.loc,
                        "the integrator \"{}\" uses no light sampler; \"path\", \"volpath\", \"bdpt\", \"mlt\" and "
                        "\"sppm\" do.",
                        integrator);
    progress.BeginPhase("building", 0);
    BuiltScene built = BuildScene(description, options, registry, sink, progress);
    progress.EndPhase();
    if (built.scene->Lights().Size() == 0) throw UserError("{}: has no lights.", file);
    for (const Diagnostic &d : sink.All())
        if (d.severity == Severity::Warning) LogInfo(Format(d));
    return built;
}

LabScene LoadLabScene(const ExperimentSettings &settings, const PluginRegistry &registry, Progress &progress) {
    LabScene scene;
    DiagnosticSink sink;
    SceneDescription description = ParseSceneFiles({settings.scene}, sink);
    BuildOptions options;
    options.film.resolutionDivisor = settings.resolutionDivisor;
    options.film.filename = "lightlab.exr";  // never written; the scene's own format may be unsupported
    options.samplesPerPixel = settings.Timed() ? 0 : settings.samplesPerPixel;
    options.maxDepth = settings.maxDepth;
    options.sampledLightOnly = settings.sampledLightOnly;
    options.lightSamplerFlag = kSamplersFlag;
    options.lightSampler = "uniform";  // for the unused default integrator: nothing to build
    scene.built = BuildLitScene(description, settings.scene, options, registry, sink, progress);
    if (std::exchange(scene.built.half, nullptr))  // relL2 at equal samples compares samplers
        LogWarning("\"bool adaptive\" has no effect here: all pixels get the same number of samples.");
    scene.hash = SceneHash(settings.scene);
    return scene;
}

}  // namespace ext::lab
