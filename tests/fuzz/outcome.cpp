#include "fuzz/outcome.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "fuzz/corpus.h"
#include "fuzz/workplace.h"

namespace pbrt::fuzz {

namespace {

using Record = nlohmann::ordered_json;

std::string FirstLineOf(const std::string &command) {
    std::unique_ptr<FILE, int (*)(FILE *)> pipe(popen(command.c_str(), "r"), pclose);
    std::array<char, 4096> line{};
    if (!pipe || !std::fgets(line.data(), int(line.size()), pipe.get())) return "";
    std::string text = line.data();
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return text;
}

/// A function's name without parameters, template arguments and the name of the anonymous namespace.
std::string ShortName(std::string name) {
    int depth = 0;
    std::string kept;
    for (size_t i = 0; i < name.size(); ++i) {
        if (name.compare(i, 21, "(anonymous namespace)") == 0) {
            i += 22;  // and "::"
            continue;
        }
        if (name[i] == '(' || name[i] == '<') ++depth;
        if (depth == 0) kept += name[i];
        if (name[i] == ')' || name[i] == '>') --depth;
    }
    size_t blank = kept.rfind(' ');
    if (blank != std::string::npos && blank + 1 < kept.size()) kept.erase(0, blank + 1);
    return kept.substr(0, 100);
}

const std::string &FunctionAt(void *address) {
    static std::map<void *, std::string> known;
    auto [it, isNew] = known.try_emplace(address);
    if (!isNew) return it->second;
    Dl_info info{};
    if (!dladdr(address, &info) || !info.dli_fname) return it->second;
    const std::string own = std::filesystem::read_symlink("/proc/self/exe").string();
    std::error_code ignored;
    const std::string file = std::filesystem::canonical(info.dli_fname, ignored).string();
    const auto offset = static_cast<char *>(address) - static_cast<char *>(info.dli_fbase) - 1;
    if (file == own) it->second = ShortName(FirstLineOf(fmt::format("addr2line -Cfe '{}' {:#x}", own, offset)));
    else if (file.find("libc.") == std::string::npos && file.find("libstdc++") == std::string::npos)
        it->second = std::filesystem::path(file).stem().stem().string();
    return it->second;
}

/// The innermost three different functions or libraries; a recursive function counts once.
std::string Where(const std::vector<void *> &frames) {
    std::vector<std::string> seen;
    for (const std::string &name : OurFunctions(frames)) {
        if (name.empty() || name.find("fuzz::") != std::string::npos || name == "??") continue;
        if (std::find(seen.begin(), seen.end(), name) == seen.end()) seen.push_back(name);
        if (seen.size() == 3) break;
    }
    std::string text;
    for (const std::string &name : seen) text += (text.empty() ? "" : " < ") + name;
    return text;
}

/// A message without the parts that differ from case to case.
std::string WithoutDetails(const std::string &message) {
    static const std::regex kQuoted("\"[^\"]*\""), kNumber(R"([-+]?\d[\d.,]*(e[-+]?\d+)?|\b-?(nan|inf)\b)"),
        kFile(R"((\S*/)?[\w.]*\.(pbrt|ply|png|exr|pfm|hdr|tga|bsdf|dat|spd|gz)\b)"), kOther("[^\\x20-\\x7e]+");
    std::string text = message.substr(0, 400);
    text = std::regex_replace(text, kOther, "?");
    text = std::regex_replace(text, kQuoted, "\"\"");
    text = std::regex_replace(text, kFile, "FILE");
    text = std::regex_replace(text, kNumber, "N");
    return text.substr(0, 160);
}

std::vector<std::string> ErrorLines(const std::string &messages) {
    std::vector<std::string> errors;
    std::istringstream lines(messages);
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with("Error: ")) errors.push_back(line.substr(7));
    return errors;
}

/// True if the message begins with the file that it is about, with or without line and column, or says in which phase
/// memory ran out.
bool HasPlace(const std::string &error) {
    static const std::regex kFile(R"(^\S*[./]\S*: )");
    return std::regex_search(error, kFile) || error.starts_with("command line: ") ||
           error.starts_with("there is not enough memory for ");
}

bool IsLibrarysMessage(const std::string &message) {
    // Text in quotation marks comes from the user.
    static const std::regex kQuoted(R"("[^"]*")");
    const std::string error = std::regex_replace(message, kQuoted, "");
    for (const char *words : {"std::", "vector::", "basic_string", "_M_", "bad_", "map::at", "terminate called",
                              "Internal error", "stoi", "unordered_map", "filesystem error", "invalid string position"})
        if (error.find(words) != std::string::npos) return true;
    return false;
}

std::string SanitizersFinding(const std::string &messages) {
    static const std::regex kRuntime(R"(([^\s/]+):\d+:\d+: runtime error: ([^\n]*))"),
        kSummary(R"(SUMMARY: (\w+Sanitizer): ([^\n]*))"), kPath(R"(\S*/|0x[0-9a-f]+)");
    std::smatch found;
    if (std::regex_search(messages, found, kRuntime)) return found[1].str() + ": " + WithoutDetails(found[2]);
    if (std::regex_search(messages, found, kSummary))
        return WithoutDetails(std::regex_replace(found[2].str(), kPath, ""));
    return "";
}

}  // namespace

const char *Name(Outcome outcome) {
    static constexpr std::array<const char *, kOutcomeCount> kNames = {"rendered", "warned",    "refused", "stopped",
                                                                       "signal",   "sanitizer", "hang",    "memory",
                                                                       "message",  "silent",    "picture", "accepted"};
    return kNames[size_t(outcome)];
}

std::vector<std::string> OurFunctions(const std::vector<void *> &frames) {
    std::vector<std::string> names;
    for (void *frame : frames) names.push_back(FunctionAt(frame));
    return names;
}

bool RendersReferenceAgain(const ChildResult &result) {
    return result.messages.find("rendered again") != std::string::npos;
}

Verdict Judge(const ChildResult &r, const FuzzCase &fuzzCase, const std::vector<std::string> &left) {
    const std::string sanitizer = SanitizersFinding(r.messages);
    if (!sanitizer.empty()) return {Outcome::Sanitizer, sanitizer};
    if (r.hung) return {Outcome::Hang, Where(r.frames)};
    if (r.signal != 0) {
        if (r.wasTerminated && r.signal == SIGTERM) return {Outcome::Stopped, ""};
        const bool memory = r.messages.find("bad_alloc") != std::string::npos;
        return {memory ? Outcome::Memory : Outcome::Signal, fmt::format("{} {}", strsignal(r.signal), Where(r.frames))};
    }
    if (r.messageBytes > (1 << 20)) return {Outcome::Message, "more than a megabyte of messages"};
    const bool isThere = std::find(left.begin(), left.end(), fuzzCase.output) != left.end();
    for (const std::string &name : left)
        if (name != fuzzCase.output) return {Outcome::Picture, "left a file: " + WithoutDetails(name)};
    if (r.wasTerminated) return {Outcome::Stopped, ""};

    if (r.status == 0) {
        using State = PictureReport::State;
        if (r.picture.state == State::Missing) return {Outcome::Silent, "no picture in spite of success"};
        if (r.picture.state == State::Bad) return {Outcome::Picture, WithoutDetails(r.picture.text.data())};
        if (fuzzCase.mustBeRefused && !(fuzzCase.isLightlab && RendersReferenceAgain(r)))
            return {Outcome::Accepted, "changed state of " + fuzzCase.seed};
        return {r.messages.find("Warning: ") == std::string::npos ? Outcome::Rendered : Outcome::Warned, ""};
    }
    if (r.status != 1) return {Outcome::Silent, fmt::format("exit status {}", r.status)};
    if (isThere) return {Outcome::Picture, "a picture in spite of an error"};
    const std::vector<std::string> errors = ErrorLines(r.messages);
    if (errors.empty()) return {Outcome::Silent, "exit status 1 without an error message"};
    for (const std::string &error : errors) {
        if (error.find("bad_alloc") != std::string::npos) return {Outcome::Memory, WithoutDetails(error)};
        if (IsLibrarysMessage(error)) return {Outcome::Message, WithoutDetails(error)};
    }
    // Later errors may be summaries.
    if (!HasPlace(errors.front())) return {Outcome::Message, "no place: " + WithoutDetails(errors.front())};
    return {Outcome::Refused, ""};
}

void Tally::Add(uint64_t number, const FuzzCase &fuzzCase, const Verdict &verdict) {
    ++cases;
    ++counts[fuzzCase.kind][size_t(verdict.outcome)];
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
    std::filesystem::create_directories(folder);
    WriteFiles(fuzzCase, folder);
    Record j = {{"outcome", Name(verdict.outcome)},
                {"cause", verdict.cause},
                {"kind", fuzzCase.kind},
                {"scene", fuzzCase.seed},
                {"arguments", fuzzCase.arguments},
                {"output", fuzzCase.output},
                {"mustBeRefused", fuzzCase.mustBeRefused},
                {"isLightlab", fuzzCase.isLightlab}};
    for (const CaseFile &file : fuzzCase.files) j["files"].push_back(file.name);
    std::ofstream(std::filesystem::path(folder) / "case.json")
        << j.dump(2, ' ', true, Record::error_handler_t::replace) << '\n';
    std::ofstream(std::filesystem::path(folder) / "messages.txt") << messages;
}

FuzzCase ReadCase(const std::string &caseJson) {
    const Record j = Record::parse(BytesOf(caseJson));
    FuzzCase fuzzCase;
    fuzzCase.kind = j.at("kind");
    fuzzCase.seed = j.at("scene");
    fuzzCase.output = j.at("output");
    fuzzCase.mustBeRefused = j.at("mustBeRefused");
    fuzzCase.isLightlab = j.at("isLightlab");
    fuzzCase.arguments = j.at("arguments").get<std::vector<std::string>>();
    for (const std::string name : j.at("files"))
        fuzzCase.files.push_back({name, BytesOf(std::filesystem::path(caseJson).parent_path() / name)});
    return fuzzCase;
}

}  // namespace pbrt::fuzz
