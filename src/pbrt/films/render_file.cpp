#include "pbrt/films/render_file.h"

#include <fmt/ranges.h>

#include <bit>
#include <nlohmann/json.hpp>

namespace pbrt {
namespace {

using Json = nlohmann::ordered_json;

uint32_t Bits(Float value) { return std::bit_cast<uint32_t>(value); }
Float FloatOf(const Json &bits) { return std::bit_cast<Float>(bits.get<uint32_t>()); }

Json JsonOf(const Param &p) {
    std::vector<uint32_t> floats;
    for (Float f : p.floats) floats.push_back(Bits(f));
    return {{"type", int(p.type)},  {"name", p.name},   {"floats", floats},     {"ints", p.ints},
            {"strings", p.strings}, {"bools", p.bools}, {"space", p.colorSpace}};
}

Param ParamOf(const Json &json) {
    Param p;
    p.type = static_cast<ParamType>(json.at("type").get<int>());
    p.name = json.at("name");
    for (const Json &bits : json.at("floats")) p.floats.push_back(FloatOf(bits));
    p.ints = json.at("ints").get<std::vector<int>>();
    p.strings = json.at("strings").get<std::vector<std::string>>();
    p.bools = json.at("bools").get<std::vector<uint8_t>>();
    p.colorSpace = json.at("space");
    return p;
}

constexpr const char *kKind = "checkpoint";
constexpr const char *kProgram = "program";
constexpr std::string_view kFile = "file ";

/// Calls f(name, member) for all members but film and metadata.
void ForEachMember(auto &head, auto &&f) {
    f("identity", head.identity);
    f("samplesFlag", head.samplesFlag);
    f("samplesPerBatch", head.samplesPerBatch);
    f("first", head.first);
    f("end", head.end);
    f("isPart", head.isPart);
    f("done", head.done);
    f("passCount", head.passCount);
    f("seconds", head.seconds);
    f("renderSeconds", head.renderSeconds);
}

/// Floats are stored as bits, because JSON lacks infinity and full precision.
Json ToJson(const ImageMetadata &metadata) {
    Json json = Json::object();
    for (const auto &[name, value] : metadata.attributes) {
        if (const int *i = std::get_if<int>(&value)) json[name] = {{"int", *i}};
        if (const float *f = std::get_if<float>(&value)) json[name] = {{"float", Bits(*f)}};
        if (const std::string *s = std::get_if<std::string>(&value)) json[name] = {{"text", *s}};
        if (const glm::mat4 *m = std::get_if<glm::mat4>(&value)) {
            Json bits = Json::array();
            for (int i = 0; i < 16; ++i) bits.push_back(Bits((*m)[i / 4][i % 4]));
            json[name] = {{"matrix", bits}};
        }
    }
    return json;
}

/// Attributes only.
ImageMetadata MetadataFromJson(const Json &json) {
    ImageMetadata metadata;
    for (const auto &[name, value] : json.items()) {
        if (value.contains("int")) metadata.attributes[name] = value["int"].get<int>();
        if (value.contains("float")) metadata.attributes[name] = FloatOf(value["float"]);
        if (value.contains("text")) metadata.attributes[name] = value["text"].get<std::string>();
        if (value.contains("matrix")) {
            glm::mat4 m;
            for (size_t i = 0; i < 16; ++i) m[int(i / 4)][int(i % 4)] = FloatOf(value["matrix"].at(i));
            metadata.attributes[name] = m;
        }
    }
    return metadata;
}

Json ToJson(const RenderFileHead &h) {
    Json json;
    ForEachMember(h, [&](const char *name, const auto &member) { json[name] = member; });
    json["film"] = h.film.ToJson();
    json["metadata"] = ToJson(h.metadata);
    return json;
}

RenderFileHead HeadOf(const StateFile &file) {
    RenderFileHead h;
    try {
        StateReader in(file.Section("head"), file.Path());
        std::string text;
        in.Structure(text);
        in.RequireEnd();
        const Json json = Json::parse(text);
        ForEachMember(h, [&](const char *name, auto &member) { json.at(name).get_to(member); });
        h.film = FilmRecipe::FromJson(json.at("film"));
        h.metadata = MetadataFromJson(json.at("metadata"));
    } catch (const Json::exception &) {
        throw UserError("{}: its content is damaged: its head is not readable.", file.Path());
    }
    StateReader({}, file.Path()).RequireValid(h.Validate());
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

std::unique_ptr<Film> FilmRecipe::Make() const {
    const ColorSpace *space = ColorSpace::Find(colorSpace);
    if (!space)
        throw UserError("colour space \"{}\" is unknown; {}.", colorSpace,
                        ListChoices(colorSpace, ColorSpace::Names()));
    DiagnosticSink sink;  // warnings were reported when the scene was built
    return MakeFilm(type, params,
                    FilmContext{.outputSpace = *space, .exposureTime = exposureTime, .overrides = overrides}, sink);
}

Json FilmRecipe::ToJson() const {
    Json json = {{"type", type},
                 {"colorSpace", colorSpace},
                 {"exposureTime", Bits(exposureTime)},
                 {"filename", overrides.filename},
                 {"resolutionDivisor", overrides.resolutionDivisor},
                 {"fullFloat", overrides.fullFloat},
                 {"aovs", overrides.aovs}};
    if (const auto &c = overrides.cropWindow)
        json["cropWindow"] = {Bits(c->low.x), Bits(c->low.y), Bits(c->high.x), Bits(c->high.y)};
    if (const auto &b = overrides.pixelBounds) json["pixelBounds"] = {b->low.x, b->low.y, b->high.x, b->high.y};
    json["parameters"] = Json::array();
    for (const Param &p : params.Own()) json["parameters"].push_back(JsonOf(p));
    return json;
}

FilmRecipe FilmRecipe::FromJson(const Json &json) {
    FilmRecipe recipe;
    recipe.type = json.at("type");
    recipe.params = ParamSet(fmt::format("Film \"{}\"", recipe.type), {});
    for (const Json &p : json.at("parameters")) recipe.params.Add(ParamOf(p));
    recipe.colorSpace = json.at("colorSpace");
    recipe.exposureTime = FloatOf(json.at("exposureTime"));
    FilmOverrides &o = recipe.overrides;
    o.filename = json.at("filename");
    o.resolutionDivisor = json.at("resolutionDivisor");
    o.fullFloat = json.at("fullFloat");
    o.aovs = json.at("aovs").get<std::vector<std::string>>();
    if (json.contains("cropWindow")) {
        const Json &c = json["cropWindow"];
        o.cropWindow = Bounds2{{FloatOf(c.at(0)), FloatOf(c.at(1))}, {FloatOf(c.at(2)), FloatOf(c.at(3))}};
    }
    if (json.contains("pixelBounds")) {
        const auto b = json["pixelBounds"].get<std::array<int, 4>>();
        o.pixelBounds = Bounds2i{{b[0], b[1]}, {b[2], b[3]}};
    }
    return recipe;
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

RenderFile::RenderFile(const std::string &path) : file_(path, kKind), head_(HeadOf(file_)) {
    StateReader({}, path).Require((head_.passCount > 0) == !PassDone().empty(), "its pass was not begun");
}

void WriteRenderFile(const std::string &path, const RenderFileHead &head, const std::vector<uint32_t> &passDone,
                     const Film &film, const StateWriter &learned, const AdaptiveState *adaptive) {
    StateWriter headBytes, pass, sums, plan, half;
    headBytes.Structure(ToJson(head).dump(-1, ' ', false, Json::error_handler_t::replace));
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
