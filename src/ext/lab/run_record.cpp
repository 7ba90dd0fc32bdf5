#include "ext/lab/run_record.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include "pbrt/core/files.h"

namespace ext::lab {
namespace {

/// Calls f(place in the file, member) for all that the file of a round holds, but its measures.
void ForEachMember(auto &run, auto &round, auto &&f) {
    f("/seed", run.seed);
    f("/checkpoint", round.checkpoint);
    f("/samples", round.samples);
    f("/spent/wall", round.spent.wall);
    f("/spent/cpu", round.spent.cpu);
    f("/shadowRays", round.shadowRays);
    f("/shadowRaysBlocked", round.shadowRaysBlocked);
    f("/expectedSamples", run.expectedSamples);
    f("/prepare/wall", run.prepare.wall);
    f("/prepare/cpu", run.prepare.cpu);
    f("/prepareShadowRays", run.prepareShadowRays);
    f("/report", run.report);
    f("/structure", run.structure);
}

bool IsPossible(const RunRecord &run) {
    const auto isTime = [](const TimeSpent &t) {
        return t.wall >= 0 && t.cpu >= 0 && std::isfinite(t.wall) && std::isfinite(t.cpu);
    };
    const RoundRecord &round = run.rounds.back();
    const int before = run.rounds.size() > 1 ? run.rounds[run.rounds.size() - 2].samples : 0;
    return round.samples >= before && run.expectedSamples > 0 && isTime(round.spent) && isTime(run.prepare) &&
           round.shadowRaysBlocked <= round.shadowRays;
}

Json ReadJson(const std::string &path) {
    std::ifstream in(path);
    return in ? Json::parse(in, nullptr, false) : Json();
}

}  // namespace

RunRecord RecordFolder::LoadRun(const std::string &sampler, int seed, size_t maxRounds) const {
    RunRecord run;
    run.seed = seed;
    for (int checkpoint = 0; run.rounds.size() < maxRounds; ++checkpoint) {
        const Json json = LoadOwn(RoundFile(sampler, seed, checkpoint));
        if (!json.is_object()) break;
        try {
            RunRecord upToHere = run;
            RoundRecord &round = upToHere.rounds.emplace_back();
            ForEachMember(upToHere, round,
                          [&](const char *place, auto &member) { json.at(Json::json_pointer(place)).get_to(member); });
            round.measures = MeasuresFromJson(json.at("metrics"));
            if (round.checkpoint != checkpoint || upToHere.seed != seed || !IsPossible(upToHere)) break;
            run = std::move(upToHere);
        } catch (const Json::exception &) {
            break;
        }
    }
    return run;
}

void RecordFolder::SaveLastRound(const std::string &sampler, const RunRecord &run) const {
    const RoundRecord &round = run.rounds.back();
    Json json = {{"experiment", experiment_}, {"metrics", ToJson(round.measures)}};
    ForEachMember(run, round, [&](const char *place, const auto &member) { json[Json::json_pointer(place)] = member; });
    WriteFile(RoundFile(sampler, run.seed, round.checkpoint), json.dump(1) + "\n");
}

size_t RecordFolder::CountRounds(const std::string &sampler, int seed, size_t checkpoints) const {
    size_t rounds = checkpoints;
    while (rounds > 0 && !std::filesystem::exists(RoundFile(sampler, seed, int(rounds) - 1))) --rounds;
    return rounds;
}

void RecordFolder::RemoveRounds(const std::string &sampler, int seed, size_t kept, size_t checkpoints) const {
    for (size_t c = 0; c < checkpoints; ++c) {
        const int checkpoint = int(c);
        if (c >= kept) std::filesystem::remove(RoundFile(sampler, seed, checkpoint));
        if (c + 1 != kept) std::filesystem::remove(FilmFile(sampler, seed, checkpoint));
    }
}

Json RecordFolder::LoadOwn(const std::string &path) const {
    Json json = ReadJson(path);
    return json.is_object() && json.contains("experiment") && json["experiment"] == experiment_ ? json : Json();
}

Json RecordFolder::LoadSettings() const { return ReadJson(File("settings.json")); }
void RecordFolder::SaveSettings(const Json &settings) const {
    WriteFile(File("settings.json"), settings.dump(1) + "\n");
}

Json RecordFolder::LoadNote(const std::string &name) const {
    const Json json = LoadOwn(File(name));
    return json.is_object() ? json.value("note", Json()) : Json();
}

void RecordFolder::SaveNote(const std::string &name, const Json &note) const {
    WriteFile(File(name), Json{{"experiment", experiment_}, {"note", note}}.dump(1) + "\n");
}

}  // namespace ext::lab
