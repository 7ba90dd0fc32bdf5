#include "pbrt/lab/sampler_choice.h"

#include <cctype>
#include <set>
#include <sstream>

#include "pbrt/build/light_sampler_spec.h"
#include "pbrt/core/files.h"

namespace pbrt::lab {

namespace {

std::string Trim(const std::string &text) {
    size_t begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string::npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
}

/// Where "+mesh", "+gate=" or another "+word" starts; numbers such as 1e+4 do not.
size_t FindSuffix(const std::string &text, size_t from) {
    for (size_t at = text.find('+', from); at != std::string::npos; at = text.find('+', at + 1))
        if (at + 1 < text.size() && std::isalpha(static_cast<unsigned char>(text[at + 1]))) return at;
    return std::string::npos;
}

SamplerChoice ParseOne(const std::string &text, const LightSamplerRegistry &registry) {
    SamplerChoice choice;
    choice.label = text;
    choice.folder = SafeFileName(text);
    size_t at = FindSuffix(text, 0);
    choice.lightSampler = text.substr(0, at);
    choice.name = choice.lightSampler.substr(0, choice.lightSampler.find(':'));
    while (at != std::string::npos) {
        size_t end = FindSuffix(text, at + 1);
        std::string suffix = text.substr(at + 1, end == std::string::npos ? end : end - at - 1);
        if (suffix == "mesh")
            choice.meshLights = true;
        else if (suffix.starts_with("gate="))
            choice.gate = suffix.substr(5);
        else
            throw UserError(
                fmt::format("\"{}\": \"+{}\" is unknown; a sampler is written "
                            "name[:key=value,...][+mesh][+gate=name[:key=value,...]].",
                            text, suffix));
        at = end;
    }
    ReadLightSamplerSpec(ParamSet(), choice.lightSampler, choice.meshLights, registry, kSamplersFlag);
    if (!choice.gate.empty()) ReadShadowGateSpec(ParamSet(), choice.gate, registry, kSamplersFlag);
    return choice;
}

}  // namespace

std::string SafeFileName(const std::string &text) {
    std::string safe = text;
    for (char &c : safe)
        if (!std::isalnum(static_cast<unsigned char>(c)) && std::string("-+=.,").find(c) == std::string::npos) c = '_';
    return safe;
}

std::vector<std::string> SplitSamplerList(const std::string &text) {
    std::vector<std::string> list;
    std::istringstream in(text);
    for (std::string piece; std::getline(in, piece, ',');) {
        size_t stop = piece.find_first_of("=:+");
        if (stop != std::string::npos && piece[stop] == '=' && !list.empty())
            list.back().append(",").append(Trim(piece));
        else
            list.push_back(Trim(piece));
    }
    return list;
}

std::vector<std::string> ReadSamplerFile(const std::string &path) {
    std::vector<std::string> list;
    std::istringstream in(ReadFileContents(path));
    for (std::string line; std::getline(in, line);)
        if (std::string sampler = Trim(line.substr(0, line.find('#'))); !sampler.empty()) list.push_back(sampler);
    if (list.empty()) throw UserError(fmt::format("{}: names no light sampler.", path));
    return list;
}

std::vector<SamplerChoice> ParseSamplerChoices(const std::vector<std::string> &texts,
                                               const LightSamplerRegistry &registry) {
    DiagnosticSink sink;
    std::vector<SamplerChoice> choices;
    std::set<std::string> labels, folders;
    if (texts.empty()) sink.Error({}, "no light sampler is named.");
    for (const std::string &text : texts) {
        try {
            if (text.empty()) throw UserError("the list of samplers has an empty entry.");
            SamplerChoice choice = ParseOne(text, registry);
            if (!labels.insert(choice.label).second)
                throw UserError(fmt::format("sampler \"{}\" is listed twice.", text));
            while (!folders.insert(choice.folder).second) choice.folder += "_";
            choices.push_back(choice);
        } catch (const UserError &e) {
            sink.Add(e);
        }
    }
    sink.ThrowIfErrors();
    return choices;
}

}  // namespace pbrt::lab
