#include "pbrt/films/render_file.h"

#include <fmt/ranges.h>

#include <istream>
#include <nlohmann/json.hpp>
#include <streambuf>

namespace pbrt {

namespace {

using Json = nlohmann::ordered_json;
constexpr const char *kKind = "checkpoint";
constexpr const char *kProgram = "program";
constexpr std::string_view kFile = "file ";

/// Reads from memory without a copy.
class View : public std::streambuf {
  public:
    explicit View(std::string_view bytes) {
        char *begin = const_cast<char *>(bytes.data());  // only read
        setg(begin, begin, begin + bytes.size());
    }
};

Json ToJson(const RenderFileHead &h) {
    return {{"identity", h.identity},
            {"samplesFlag", h.samplesFlag},
            {"samplesPerBatch", h.samplesPerBatch},
            {"first", h.first},
            {"end", h.end},
            {"isPart", h.isPart},
            {"done", h.done},
            {"passCount", h.passCount},
            {"seconds", h.seconds},
            {"renderSeconds", h.renderSeconds},
            {"film", h.film.ToJson()},
            {"metadata", pbrt::ToJson(h.metadata)}};
}

RenderFileHead HeadOf(const StateFile &file) {
    RenderFileHead h;
    try {
        const Json json = Json::parse(file.Section("head"));
        h.identity = json.at("identity").get<RenderIdentity>();
        h.samplesFlag = json.at("samplesFlag");
        h.samplesPerBatch = json.at("samplesPerBatch");
        h.first = json.at("first");
        h.end = json.at("end");
        h.isPart = json.at("isPart");
        h.done = json.at("done");
        h.passCount = json.at("passCount");
        h.seconds = json.at("seconds");
        h.renderSeconds = json.at("renderSeconds");
        h.film = FilmRecipe::FromJson(json.at("film"));
        h.metadata = MetadataFromJson(json.at("metadata"));
    } catch (const Json::exception &) {
        throw UserError(fmt::format("{}: its content is damaged.", file.Path()));
    }
    return h;
}

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

RenderFile::RenderFile(const std::string &path) : file_(path, kKind), head_(HeadOf(file_)) {}

std::vector<uint32_t> RenderFile::PassDone() const {
    std::vector<uint32_t> done;
    StateReader(file_.Section("pass"), Path()).Vector(&done);
    return done;
}

void RenderFile::LoadFilm(Film &film) const {
    View view(file_.Section("film"));
    std::istream in(&view);
    film.Load(in);
}

void RenderFile::MergeFilm(Film &film) const {
    View view(file_.Section("film"));
    std::istream in(&view);
    film.Merge(in);
}

void WriteRenderFile(const std::string &path, const RenderFileHead &head, const std::vector<uint32_t> &passDone,
                     const Film &film, const StateWriter &learned) {
    StateWriter headBytes, pass, sums;
    const std::string text = ToJson(head).dump(-1, ' ', false, Json::error_handler_t::replace);
    headBytes.Copy(text.data(), text.size());
    pass.Vector(passDone);
    film.Save(sums);
    WriteStateFile(path, kKind, {{"head", &headBytes}, {"pass", &pass}, {"film", &sums}, {"learned", &learned}});
}

}  // namespace pbrt
