#include "ext/lab/experiment_settings.h"

#include "pbrt/core/files.h"
#include "pbrt/core/version.h"
#include "pbrt/scenefile/content_hash.h"

namespace ext::lab {

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
    if (!settings.referenceFile.empty()) {
        ContentHash content;
        content.Add(ReadFileContents(settings.referenceFile));
        id["reference-content"] = content.Hex();
    }
    id["reference-spp"] = settings.referenceSamples;
    id["samples-from"] = settings.samplesFrom.empty() ? "" : SampleCounts(settings.samplesFrom, settings).Hash();
    id["threads"] = threads;
    return id;
}

std::string ExperimentKey(Json identity) {
    identity.erase("seeds");
    ContentHash hash;
    hash.Add("records 2 " + identity.dump());
    return hash.Hex();
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
        throw UserError(fmt::format("{}: is not a results.json of lightlab.", path));
    return json;
}

SampleCounts::SampleCounts(const std::string &path, const ExperimentSettings &settings) {
    const Json results = ReadResults(path);
    ContentHash hash;
    try {
        checkpoints_ = results.at("settings").at("checkpoints").get<int>();
        for (const Json &sampler : results.at("samplers"))
            for (const Json &run : sampler.at("runs")) {
                std::vector<int> &counts = counts_[{sampler.at("label").get<std::string>(), run.at("seed").get<int>()}];
                counts.assign(checkpoints_, 0);
                for (const Json &round : run.at("rounds"))
                    counts.at(round.at("checkpoint").get<size_t>()) = round.at("samples").get<int>();
                for (size_t i = 1; i < counts.size(); ++i) counts[i] = std::max(counts[i], counts[i - 1]);
                int &expected = expected_[sampler.at("label").get<std::string>()];
                expected = run.at("expectedSamples").get<int>();
                hash.Add(fmt::format("{} {}", expected, Json(counts).dump()));
            }
    } catch (const std::exception &) {
        throw UserError(fmt::format("{}: the sample counts cannot be read.", path));
    }
    for (const SamplerChoice &s : settings.samplers)
        for (int seed = 0; seed < settings.seeds; ++seed)
            if (!counts_.contains({s.label, seed}))
                throw UserError(fmt::format("{}: has no run of sampler \"{}\" with seed {}.", path, s.label, seed));
    hash_ = hash.Hex();
}

int SampleCounts::At(const std::string &label, int seed, int checkpoint) const {
    return counts_.at({label, seed}).at(checkpoint);
}

}  // namespace ext::lab
