#include "pbrt/films/render_file.h"

#include <fmt/ranges.h>

namespace pbrt {
namespace {

constexpr const char *kKind = "checkpoint";
constexpr const char *kProgram = "program";
constexpr std::string_view kFile = "file ";

std::string DifferenceOf(const std::string &key, const std::string *mine, const std::string *other,
                         const std::string &otherName) {
    if (key == kProgram)
        return fmt::format("the program is another build ({}; {} is of {})", mine ? *mine : "unknown", otherName,
                           other ? *other : "an unknown one");
    if (key.starts_with(kFile)) {
        const std::string name = key.substr(kFile.size());
        if (mine && other) return fmt::format("the content of the file {} differs", name);
        return mine ? fmt::format("the file {} did not belong to {}", name, otherName)
                    : fmt::format("only {} uses the file {}", otherName, name);
    }
    const auto given = [](const std::string *value) {
        return !value ? "is not given" : value->empty() ? "is given" : fmt::format("is {}", *value);
    };
    return fmt::format("{} {}, but {} in {}", key, given(mine), given(other), otherName);
}

}  // namespace

std::unique_ptr<Film> FilmRecipe::Make() const {
    const ColorSpace *space = ColorSpace::Find(colorSpace);
    if (!space)
        throw UserError("colour space \"{}\" is unknown; {}.", colorSpace,
                        ListChoices(colorSpace, ColorSpace::Names()));
    DiagnosticSink sink;  // warnings were reported when the scene was built
    return MakeFilm(type, params,
                    FilmContext{.outputSpace = *space, .exposureTime = exposureTime, .overrides = overrides}, sink);
}

std::string DifferencesOf(const RenderIdentity &mine, const RenderIdentity &other, const std::string &otherName) {
    const auto find = [](const RenderIdentity &identity, const std::string &key) {
        const auto it = identity.find(key);
        return it != identity.end() ? &it->second : nullptr;
    };
    RenderIdentity all = mine;
    all.insert(other.begin(), other.end());
    std::vector<std::string> differences;
    for (const auto &[key, ignored] : all) {
        const std::string *a = find(mine, key), *b = find(other, key);
        if (!a || !b || *a != *b) differences.push_back(DifferenceOf(key, a, b, otherName));
    }
    return fmt::format("{}", fmt::join(differences, "; "));
}

RenderFile::RenderFile(const std::string &path) : file_(path, kKind) {
    StateReader in(file_.Section("head"), path);
    in.Structure(head_);
    in.RequireEnd();
    StateReader({}, path).Require((head_.passCount > 0) == !PassDone().empty(), "its pass was not begun");
}

void WriteRenderFile(const std::string &path, const RenderFileHead &head, const std::vector<uint32_t> &passDone,
                     const Film &film, const StateWriter &learned, const AdaptiveState *adaptive) {
    StateWriter headBytes, pass, sums, plan, half;
    headBytes.Structure(head);
    pass.Structure(passDone);
    film.Save(sums);
    std::map<std::string, const StateWriter *> sections = {
        {"head", &headBytes}, {"pass", &pass}, {"film", &sums}, {"learned", &learned}};
    if (adaptive) {
        plan(adaptive->plan);
        adaptive->half.Save(half);
        sections.insert({{"plan", &plan}, {"half film", &half}});
    }
    WriteStateFile(path, kKind, sections);
}

}  // namespace pbrt
