#include "fuzz/report.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "fuzz/workplace.h"

namespace pbrt::fuzz {

namespace fs = std::filesystem;
using Record = nlohmann::ordered_json;

void Tally::Add(uint64_t number, const FuzzCase &fuzzCase, const Verdict &verdict) {
    ++cases;
    ++counts[fuzzCase.kind][static_cast<size_t>(verdict.outcome)];
    if (!IsFailure(verdict.outcome)) return;
    const std::string key = fmt::format("{}: {}", Name(verdict.outcome), verdict.cause);
    auto [it, isNew] = causes.try_emplace(key, Cause{verdict.outcome, 0, number, ""});
    ++it->second.count;
    it->second.firstNumber = std::min(it->second.firstNumber, number);
}

uint64_t Tally::Failures() const {
    uint64_t failures = 0;
    for (const auto &[name, cause] : causes) failures += cause.count;
    return failures;
}

std::string Markdown(const Tally &tally) {
    std::string out = fmt::format(
        "{} cases (seed {}, from case {}) in {:.0f} s by {}: {} failures of {} causes.\n\n| mutation | cases |",
        tally.cases, tally.seed, tally.from, tally.seconds, tally.version, tally.Failures(), tally.causes.size());
    std::string line = "\n|---|---|";
    for (int o = 0; o < kOutcomeCount; ++o) {
        out += fmt::format(" {} |", Name(static_cast<Outcome>(o)));
        line += "---|";
    }
    out += line + '\n';
    std::array<uint64_t, kOutcomeCount> all{};
    auto row = [&](const std::string &name, const std::array<uint64_t, kOutcomeCount> &counts) {
        uint64_t sum = 0;
        std::string cells;
        for (uint64_t n : counts) {
            sum += n;
            cells += fmt::format(" {} |", n);
        }
        out += fmt::format("| {} | {} |{}\n", name, sum, cells);
    };
    for (const auto &[kind, counts] : tally.counts) {
        row(kind, counts);
        for (size_t o = 0; o < all.size(); ++o) all[o] += counts[o];
    }
    row("all", all);
    if (!tally.causes.empty()) out += "\n| failures | first case | cause |\n|---|---|---|\n";
    for (const auto &[name, cause] : tally.causes)
        out += fmt::format("| {} | {} | {} |\n", cause.count, cause.firstNumber, name);
    return out;
}

void SaveCase(const std::string &folder, const FuzzCase &fuzzCase, const Verdict &verdict,
              const std::string &messages) {
    fs::create_directories(folder);
    WriteFiles(fuzzCase, folder);
    Record j;
    j["outcome"] = Name(verdict.outcome);
    j["cause"] = verdict.cause;
    j["kind"] = fuzzCase.kind;
    j["scene"] = fuzzCase.seed;
    for (const CaseFile &file : fuzzCase.files) j["files"].push_back(file.name);
    j["arguments"] = fuzzCase.arguments;
    j["output"] = fuzzCase.output;
    j["mustBeRefused"] = fuzzCase.mustBeRefused;
    j["isLightlab"] = fuzzCase.isLightlab;
    std::ofstream(fs::path(folder) / "case.json") << j.dump(2, ' ', true, Record::error_handler_t::replace) << '\n';
    std::ofstream(fs::path(folder) / "messages.txt") << messages;
}

FuzzCase ReadCase(const std::string &caseJson) {
    std::ifstream in(caseJson);
    const Record j = Record::parse(in);
    FuzzCase fuzzCase;
    fuzzCase.kind = j.at("kind");
    fuzzCase.seed = j.at("scene");
    fuzzCase.output = j.at("output");
    fuzzCase.mustBeRefused = j.at("mustBeRefused");
    fuzzCase.isLightlab = j.at("isLightlab");
    for (const std::string argument : j.at("arguments")) fuzzCase.arguments.push_back(argument);
    for (const std::string name : j.at("files")) {
        std::ostringstream bytes;
        bytes << std::ifstream(fs::path(caseJson).parent_path() / name, std::ios::binary).rdbuf();
        fuzzCase.files.push_back({name, bytes.str()});
    }
    return fuzzCase;
}

}  // namespace pbrt::fuzz
