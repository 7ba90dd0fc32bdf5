#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "pbrt/build/geometry_builder.h"
#include "pbrt/build/integrator_builder.h"
#include "pbrt/cameras/camera.h"
#include "pbrt/films/film.h"
#include "pbrt/films/filter.h"
#include "pbrt/lights/light_factory.h"
#include "pbrt/materials/material_factory.h"
#include "pbrt/media/medium_factory.h"
#include "pbrt/samplers/sampler.h"
#include "pbrt/textures/texture_makers.h"

namespace pbrt {
namespace {

/// Appends the parameters of direction sampling, as named in scenes, to the integrators that use it.
FamilyDoc DocumentIntegrators(const DirectionSamplings &directions) {
    FamilyDoc doc = Integrators().Document("integrators");
    for (FactoryDoc &maker : doc.makers) {
        if (!TraitsOf(maker.name).isGuided) continue;
        for (const std::string &name : directions.Names())
            for (ParamDoc param : directions.Find(name).params) {
                param.name = name + "." + param.name;
                maker.params.push_back(param);
            }
    }
    return doc;
}

/// With the texture parameters, which shapes do not read themselves.
FamilyDoc DocumentShapes() {
    FamilyDoc doc = Shapes().Document("shapes");
    for (FactoryDoc &shape : doc.makers) {
        std::vector<ParamDoc> textures = DocumentParams(ShapeTextureParams{IsDisplaceable(shape.name)});
        shape.params.insert(shape.params.end(), textures.begin(), textures.end());
    }
    return doc;
}

/// Row of a Markdown table, up to the columns that follow the meaning.
std::string ParameterRow(const ParamDoc &p, const std::string &prefix = "") {
    return fmt::format("|`{} {}{}`|{}|{}|{}|", p.TypeText(), prefix, p.name, p.defaultValue, p.range, p.help);
}

/// Markdown table with a row for each parameter and the entities that share it.
std::string ParameterTable(const FamilyDoc &family) {
    std::vector<std::string> rows, without;
    std::map<std::string, std::vector<std::string>> entitiesOf;
    for (const FactoryDoc &maker : family.makers) {
        if (maker.params.empty()) without.push_back(maker.name);
        for (const ParamDoc &p : maker.params) {
            std::string row = ParameterRow(p);
            std::vector<std::string> &entities = entitiesOf[row];
            if (entities.empty()) rows.push_back(std::move(row));
            entities.push_back(maker.name);
        }
    }
    const size_t all = family.makers.size() - without.size();
    std::string text = "|parameter|default|values|meaning|of|\n|---|---|---|---|---|\n";
    for (const std::string &row : rows) {
        const std::vector<std::string> &entities = entitiesOf[row];
        text +=
            fmt::format("{}{}|\n", row, entities.size() == all ? "all" : fmt::format("{}", fmt::join(entities, ", ")));
    }
    if (!without.empty()) text += fmt::format("\nWithout parameters: {}.\n", fmt::join(without, ", "));
    return text;
}

/// Text of docs/reference/parameters.md.
std::string ParameterPage(std::vector<FamilyDoc> families) {
    std::string text =
        "# Parameters\n\nThe output of `pbrt --list all`. Those of light samplers are in "
        "[lightsamplers.md](lightsamplers.md); remarks on entities are in [compatibility.md](compatibility.md).\n";
    for (FamilyDoc &family : families) {
        text += fmt::format("\n## {}\n\n", family.name);
        if (family.name == "spectrumtextures") {
            std::vector<std::string> shared = SpectrumTextures().Names();
            std::erase_if(shared, [](const std::string &name) { return !FloatTextures().Has(name); });
            std::erase_if(family.makers, [](const FactoryDoc &maker) { return FloatTextures().Has(maker.name); });
            text += fmt::format("As floattextures, with spectra for values: {}. Further:\n\n", fmt::join(shared, ", "));
        }
        text += ParameterTable(family);
    }
    return text;
}

/// Text of docs/reference/lightsamplers.md.
std::string LightSamplerPage(const FamilyDoc &family) {
    std::string text =
        "# Light samplers\n\nThe output of `pbrt --list lightsamplertables`. A parameter is set by "
        "`\"float octree.budget\" 0.02` of the integrator, or by `--lightsampler octree:budget=0.02`. A sampler "
        "without a parameter `meshlights` takes `\"bool meshlights\"` of the integrator (`+mesh` in flags): an "
        "emissive mesh is one light, and its triangles are chosen by power.\n";
    for (const FactoryDoc &maker : family.makers) {
        text += fmt::format("\n## {}\n\n{}\n\n", maker.name, maker.summary);
        text += maker.params.empty() ? "No parameters.\n" : "|parameter|default|values|meaning|\n|---|---|---|---|\n";
        for (const ParamDoc &p : maker.params) text += ParameterRow(p, maker.name + '.') + '\n';
    }
    return text;
}

/// All scene entities with their parameters, in scene file order. Excludes light samplers, listed by their registry.
/// Guided integrators include the parameters of direction sampling.
std::vector<FamilyDoc> AllFamilies(const PluginRegistry &registry) {
    std::vector<FamilyDoc> all = {Cameras().Document("cameras"),
                                  Films().Document("films"),
                                  Filters().Document("filters"),
                                  Samplers().Document("samplers"),
                                  DocumentIntegrators(registry.directionSamplings),
                                  Accelerators().Document("accelerators"),
                                  DocumentShapes(),
                                  Materials().Document("materials"),
                                  FloatTextures().Document("floattextures"),
                                  SpectrumTextures().Document("spectrumtextures"),
                                  Lights().Document("lights"),
                                  AreaLights().Document("arealights"),
                                  Media().Document("media")};
    for (FamilyDoc &family : all) {
        if (family.name == "floattextures") family.what = "Texture \"...\" \"float\"";
        if (family.name == "spectrumtextures") family.what = "Texture \"...\" \"spectrum\"";
    }
    return all;
}

/// True for the families of a replaced directive, or of a target of Attribute.
bool IsOf(const FamilyDoc &family, const std::string &key) {
    static const std::map<std::string, std::vector<std::string>> ofTarget = {
        {"light", {"lights", "arealights"}},
        {"material", {"materials"}},
        {"medium", {"media"}},
        {"shape", {"shapes"}},
        {"texture", {"floattextures", "spectrumtextures"}}};
    const auto target = ofTarget.find(key);
    return target == ofTarget.end() ? family.what == key : std::ranges::count(target->second, family.name) > 0;
}

}  // namespace

void CheckUnbuilt(const SceneDescription &d, const PluginRegistry &registry, DiagnosticSink &sink) {
    if (d.unbuilt.empty()) return;
    const std::vector<FamilyDoc> families = AllFamilies(registry);
    const auto check = [&](const std::string &key, const Entity &entity) {
        if (key == "Integrator") {
            if (entity.type != kUnsupportedIntegrator) ReadIntegrator(entity, {}, registry, sink);
            return;
        }
        ParamReader reader(entity.params);
        std::set<std::pair<std::string, ParamType>> declared;
        if (key == "material" || key == "medium") reader.Declare("type", ParamType::String);
        for (const FamilyDoc &family : families) {
            if (!IsOf(family, key)) continue;
            std::vector<std::string> names;
            for (const FactoryDoc &maker : family.makers) {
                names.push_back(maker.name);
                if (!entity.type.empty() && entity.type != maker.name) continue;
                for (const ParamDoc &doc : maker.params)
                    for (const ParamType type : doc.types)
                        if (declared.insert({doc.name, type}).second) reader.Declare(doc.name, type);
            }
            if (!entity.type.empty() && std::ranges::find(names, entity.type) == names.end())
                ThrowUnknown(family.what, entity.type, names, entity.loc);
        }
        reader.Finish(sink);
    };
    for (const auto &[key, entities] : d.unbuilt)
        for (const Entity &entity : entities) Collect(sink, [&] { check(key, entity); });
}

std::string ListWhat(const std::string &what, const PluginRegistry &registry) {
    const std::vector<FamilyDoc> families = AllFamilies(registry);
    if (what == "table") {
        std::string text = "| entity | parameters | remark |\n|---|---|---|\n";
        for (const FamilyDoc &family : families) text += TableRowsOf(family);
        return text;
    }
    if (what == "all") return ParameterPage(families);
    if (what == "lightsamplertables") return LightSamplerPage(registry.samplers.Document("lightsamplers"));
    std::vector<std::string> names = {"all", "table", "lightsamplertables"};
    for (const FamilyDoc &family : families) {
        if (family.name == what) return ListingOf(family);
        names.push_back(family.name);
    }
    names.push_back("lightsamplers");
    ThrowUnknown("--list", what, names, {});
}

}  // namespace pbrt
