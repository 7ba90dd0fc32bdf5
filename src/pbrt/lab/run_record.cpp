#include "pbrt/lab/run_record.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"

namespace pbrt::lab {

using Json = nlohmann::ordered_json;

namespace {

Json ToJson(const TimeSpent &t) { return {{"wall", t.wall}, {"cpu", t.cpu}}; }
TimeSpent TimeFromJson(const Json &json) { return {json.at("wall").get<double>(), json.at("cpu").get<double>()}; }

Json ReadJson(const std::string &path) {
    std::ifstream in(path);
    return in ? Json::parse(in, nullptr, false) : Json();
}

}  // namespace

void WriteText(const std::string &path, const std::string &text) { WriteFile(path, text); }

std::string RecordFolder::RoundFile(const std::string &sampler, int seed, int checkpoint) const {
    return fmt::format("{}/{}/seed{}-round{:02}.json", folder_, sampler, seed, checkpoint);
}

std::string RecordFolder::FilmFile(const std::string &sampler, int seed, int checkpoint) const {
    return fmt::format("{}/{}/seed{}-round{:02}.film", folder_, sampler, seed, checkpoint);
}

RunRecord RecordFolder::LoadRun(const std::string &sampler, int seed) const {
    RunRecord run;
    run.seed = seed;
    for (int checkpoint = 0;; ++checkpoint) {
        const Json json = ReadJson(RoundFile(sampler, seed, checkpoint));
        if (!json.is_object()) break;
        try {
            RoundRecord round;
            round.checkpoint = checkpoint;
            round.samples = json.at("samples").get<int>();
            round.spent = TimeFromJson(json.at("spent"));
            round.shadowRays = json.at("shadowRays").get<uint64_t>();
            round.shadowRaysBlocked = json.at("shadowRaysBlocked").get<uint64_t>();
            round.measures = MeasuresFromJson(json.at("metrics"));
            run.expectedSamples = json.at("expectedSamples").get<int>();
            run.prepare = TimeFromJson(json.at("prepare"));
            run.prepareShadowRays = json.at("prepareShadowRays").get<uint64_t>();
            run.report = json.at("report");
            run.gateReport = json.at("gateReport");
            run.structure = json.at("structure").get<std::string>();
            run.rounds.push_back(round);
        } catch (const Json::exception &) {
            break;
        }
    }
    return run;
}

void RecordFolder::SaveLastRound(const std::string &sampler, const RunRecord &run) const {
    const RoundRecord &round = run.rounds.back();
    Json json;
    json["seed"] = run.seed;
    json["checkpoint"] = round.checkpoint;
    json["samples"] = round.samples;
    json["spent"] = ToJson(round.spent);
    json["metrics"] = ToJson(round.measures);
    json["shadowRays"] = round.shadowRays;
    json["shadowRaysBlocked"] = round.shadowRaysBlocked;
    json["expectedSamples"] = run.expectedSamples;
    json["prepare"] = ToJson(run.prepare);
    json["prepareShadowRays"] = run.prepareShadowRays;
    json["report"] = run.report;
    json["gateReport"] = run.gateReport;
    json["structure"] = run.structure;
    WriteText(RoundFile(sampler, run.seed, round.checkpoint), json.dump(1) + "\n");
}

Json RecordFolder::LoadNote(const std::string &name) const {
    Json json = ReadJson(File(name));
    return json.is_discarded() ? Json() : json;
}

void RecordFolder::SaveNote(const std::string &name, const Json &note) const {
    WriteText(File(name), note.dump(1) + "\n");
}

}  // namespace pbrt::lab
