#include "pbrt/build/catalogue.h"

#include "pbrt/build/accelerators.h"
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
}  // namespace

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

std::string ListWhat(const std::string &what, const PluginRegistry &registry) {
    const std::vector<FamilyDoc> families = AllFamilies(registry);
    std::string text;
    if (what == "table") {
        text = "| entity | parameters | remark |\n|---|---|---|\n";
        for (const FamilyDoc &family : families) text += TableRowsOf(family);
        return text;
    }
    if (what == "all") {
        text =
            "# Parameters\n\nThe output of `pbrt --list all`: parameters with their types, defaults, ranges and what "
            "they mean. Those of light samplers are in lightsamplers.md.\n";
        for (const FamilyDoc &family : families)
            text += fmt::format("\n## {}\n\n```\n{}```\n", family.name, ListingOf(family));
        return text;
    }
    std::vector<std::string> names = {"all", "table"};
    for (const FamilyDoc &family : families) {
        if (family.name == what) return ListingOf(family);
        names.push_back(family.name);
    }
    names.push_back("lightsamplers");
    ThrowUnknown("--list", what, names, {});
}

}  // namespace pbrt
