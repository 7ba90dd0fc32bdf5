#include "ext/lab/sampler_choice.h"

#include <cctype>
#include <set>
#include <sstream>

#include "pbrt/build/light_sampler_spec.h"
#include "pbrt/core/files.h"
#include "pbrt/core/log.h"

namespace ext::lab {

namespace {

std::string Trim(const std::string &text) {
    size_t begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string::npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
}

SamplerChoice ParseOne(const std::string &text, const PluginRegistry &registry, DiagnosticSink &sink) {
    const LightChoiceText parts = SplitLightChoice(text, kSamplersFlag);
    SamplerChoice choice;
    choice.label = text;
    choice.folder = SafeFileName(text);
    choice.lightSampler = parts.sampler;
    if (parts.guide) choice.lightSampler += parts.guide->empty() ? "+guide" : "+guide:" + *parts.guide;
    choice.name = parts.sampler.substr(0, parts.sampler.find(':'));
    choice.meshLights = parts.mesh;
    LightFlags flags;
    flags.choice = text;
    flags.choiceFlag = kSamplersFlag;
    ReadLightSelection(ParamSet(), flags, registry, sink);
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
    std::istringstream groups(text);
    for (std::string group; std::getline(groups, group, ';');) {
        const size_t first = list.size();
        std::istringstream in(group);
        for (std::string piece; std::getline(in, piece, ',');) {
            size_t stop = piece.find_first_of("=:+");
            if (stop != std::string::npos && piece[stop] == '=' && list.size() > first)
                list.back().append(",").append(Trim(piece));
            else list.push_back(Trim(piece));
        }
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

std::vector<SamplerChoice> ParseSamplerChoices(const std::vector<std::string> &texts, const PluginRegistry &registry) {
    DiagnosticSink sink;
    std::vector<SamplerChoice> choices;
    std::set<std::string> labels, folders;
    if (texts.empty()) sink.Error({}, "no light sampler is named.");
    for (const std::string &text : texts) {
        try {
            if (text.empty()) throw UserError("the list of samplers has an empty entry.");
            SamplerChoice choice = ParseOne(text, registry, sink);
            if (!labels.insert(choice.label).second)
                throw UserError(fmt::format("sampler \"{}\" is listed twice.", text));
            while (!folders.insert(choice.folder).second) choice.folder += "_";
            choices.push_back(choice);
        } catch (const UserError &e) {
            sink.Add(e);
        }
    }
    sink.ThrowIfErrors();
    for (const Diagnostic &warning : sink.All()) LogInfo(Format(warning));
    return choices;
}

}  // namespace ext::lab
