#include "pbrt/scenefile/description_builder.h"

#include <ranges>

namespace pbrt {

void DescriptionBuilder::Fill(Entity &entity, const std::string &type, const char *directive, Params params,
                              const FileLoc &loc, std::optional<AttributeTarget> target) const {
    const GraphicsState &s = units_.back().state;
    entity.type = type;
    entity.loc = loc;
    entity.colorSpace = s.colorSpace;
    entity.params = ParamSet(fmt::format("{} \"{}\"", directive, Abbreviate(type)), loc);
    if (const auto *defaults = target ? s.attributes[size_t(*target)].get() : nullptr)
        for (Param p : *defaults) {
            // As in stock pbrt-v4, all parameters of an entity use the colour space current at the entity.
            p.colorSpace = s.colorSpace;
            entity.params.AddDefault(std::move(p));
        }
    for (Param &p : params) entity.params.Add(std::move(p));
}

void DescriptionBuilder::CloseBlock(BlockKind kind, const FileLoc &loc) {
    Unit &unit = units_.back();
    const char *word = kind == BlockKind::Attributes ? "Attribute" : "Object";
    auto matching =
        std::find_if(unit.blocks.rbegin(), unit.blocks.rend(), [&](const OpenBlock &b) { return b.kind == kind; });
    if (matching == unit.blocks.rend()) {
        if (kind == BlockKind::Object) sink_.Error(loc, "ObjectEnd without ObjectBegin.");
        else if (unit.blocks.empty()) sink_.Warning(loc, "AttributeEnd without AttributeBegin; it is ignored.");
        else
            sink_.Error(loc, "AttributeEnd inside the ObjectBegin of {}:{}, which it cannot end.",
                        unit.blocks.back().loc.file->name, unit.blocks.back().loc.line);
        return;
    }
    // Also ends blocks opened further inside, so that one mistake gives one message.
    for (; unit.blocks.back().kind != kind; unit.blocks.pop_back())
        sink_.Error(unit.blocks.back().loc, "This {} has no end before the {}End at {}:{}.",
                    kind == BlockKind::Attributes ? "ObjectBegin" : "AttributeBegin", word,
                    loc.file ? loc.file->name : "", loc.line);
    OpenBlock &block = unit.blocks.back();
    unit.state = std::move(block.saved);
    unit.object = block.outerObject;
    unit.blocks.pop_back();
}

void DescriptionBuilder::FillNamed(Entity &entity, const std::string &name, const char *directive, Params params,
                                   const FileLoc &loc, AttributeTarget target) {
    auto isType = [](const Param &p) { return p.name == "type" && p.type == ParamType::String; };
    const auto own = std::find_if(params.rbegin(), params.rend(), isType);
    std::optional<Param> type;
    if (own != params.rend()) type = *own;
    std::erase_if(params, isType);
    Fill(entity, name, directive, std::move(params), loc, target);
    if (const Param *p = entity.params.Find("type", ParamType::String); p && !type) type = *p;
    if (!type) sink_.Error(loc, "{} needs a parameter \"string type\".", directive);
    else if (type->strings.size() != 1)
        sink_.Error(type->loc, "{}: \"string type\" takes 1 value, found {}.", entity.params.What(),
                    type->strings.size());
    else entity.type = type->strings[0];
}

void DescriptionBuilder::AddShape(const std::string &type, Params params, const FileLoc &loc) {
    Unit &unit = units_.back();
    const GraphicsState &s = unit.state;
    ShapeEntity shape;
    Fill(shape, type, "Shape", std::move(params), loc, AttributeTarget::Shape);
    static_cast<ShapeState &>(shape) = s;
    if (s.areaLight && unit.object != kNoObject) {
        if (!std::exchange(s.areaLight->warnedInObject, true))
            sink_.Warning(loc, "Area lights are not supported inside object definitions: shapes here do not emit.");
    } else if (s.areaLight) {
        if (shape.ctm.IsAnimated()) sink_.Error(loc, "A shape that emits light cannot move.");
        PendingAreaLight &light = *s.areaLight;
        if (light.index < 0) {
            light.index = int(scene_.areaLights.size());
            scene_.areaLights.push_back(std::move(light.entity));
        }
        shape.areaLight = light.index;
    }
    if (unit.object >= 0) scene_.objects[unit.object].shapes.push_back(std::move(shape));
    else if (unit.object == kNoObject) scene_.shapes.push_back(std::move(shape));
}

void DescriptionBuilder::CheckMaterials() {
    struct Missing {
        FileLoc firstUse;
        size_t shapes = 0;
    };
    std::map<std::string, Missing> missing;
    ForEachShape(scene_, [&](const ShapeEntity &shape) {
        if (shape.material.name.empty() || materialNames_.contains(shape.material.name)) return;
        Missing &m = missing[shape.material.name];
        if (m.shapes++ == 0) m.firstUse = shape.loc;
    });
    for (const auto &[name, m] : missing)
        sink_.Error(m.firstUse, "This shape uses the named material \"{}\", which is not defined{}; {}.",
                    Abbreviate(name), m.shapes > 1 ? fmt::format(" (so do {} others)", m.shapes - 1) : "",
                    ListNames(sink_, name, std::views::keys(materialNames_), "no material is"));
}

void DescriptionBuilder::CheckMedia() {
    std::set<std::string> reported;
    const auto names = std::views::transform(scene_.media, &MediumEntity::name);
    auto check = [&](const std::string &name, const FileLoc &loc) {
        if (name.empty() || mediumIndex_.contains(name) || !reported.insert(name).second) return;
        sink_.Error(loc, "Medium \"{}\" is used here but not defined; {}.", Abbreviate(name),
                    ListNames(sink_, name, names, "no medium is"));
    };
    check(scene_.camera.medium, scene_.camera.loc);
    for (const LightEntity &light : scene_.lights) check(light.medium, light.loc);
    ForEachShape(scene_, [&](const ShapeEntity &shape) {
        check(shape.insideMedium, shape.loc);
        check(shape.outsideMedium, shape.loc);
    });
}

}  // namespace pbrt
