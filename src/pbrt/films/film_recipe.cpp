#include "pbrt/films/film_recipe.h"

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

}  // namespace

std::unique_ptr<Film> FilmRecipe::Make() const {
    const ColorSpace *space = ColorSpace::Find(colorSpace);
    if (!space) throw UserError("colour space \"{}\" is unknown.", colorSpace);
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

}  // namespace pbrt
