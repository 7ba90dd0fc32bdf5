#include "pbrt/scenefile/description_builder.h"

#include <algorithm>
#include <utility>

namespace pbrt {
namespace {

/// "; it was first defined at FILE:LINE", or "" if the location is unknown.
std::string FirstDefinedAt(const FileLoc &loc) {
    return loc ? fmt::format("; it was first defined at {}:{}", loc.file->name, loc.line) : std::string();
}

}  // namespace

void DescriptionBuilder::WrongBlock(std::string_view word, const FileLoc &loc) {
    if (!wrongBlockWords_.insert(std::string(word)).second) return;
    if (word == "WorldBegin") sink_.Error(loc, "WorldBegin was given before: a scene has one.");
    else
        sink_.Error(loc, inWorld_ ? fmt::format("{} is not allowed after WorldBegin: it belongs to the options.", word)
                                  : fmt::format("{} is not allowed before WorldBegin.", word));
}

void DescriptionBuilder::Concat(const Transform &t, const FileLoc &loc) {
    GraphicsState &s = State();
    TransformPair next = s.ctm;
    if (s.startActive) next.start = next.start * t;
    if (s.endActive) next.end = next.end * t;
    if (next.start.IsFinite() && next.end.IsFinite()) s.ctm = next;
    else
        sink_.Error(loc,
                    "After this directive the current transformation would have elements beyond the largest 32-bit "
                    "float, 3.4e+38.");
}

void DescriptionBuilder::SetTransform(const Transform &t) {
    GraphicsState &s = State();
    if (s.startActive) s.ctm.start = t;
    if (s.endActive) s.ctm.end = t;
}

void DescriptionBuilder::UseCoordinateSystem(const GivenName &name) {
    const auto &known = units_.back().coordinateSystems;
    auto found = known.find(name.text);
    if (found != known.end()) {
        State().ctm = found->second;
        return;
    }
    std::vector<std::string> names;
    for (const auto &[knownName, pair] : known) names.push_back(knownName);
    sink_.Warning(name.loc, "Coordinate system \"{}\" is not defined; the transformation stays as it is ({}).",
                  name.text, names.empty() ? "none is defined" : ListChoices(name.text, names));
}

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

void DescriptionBuilder::SetCamera(const std::string &type, Params params, const FileLoc &loc) {
    const GraphicsState &s = State();
    CameraEntity camera;
    Fill(camera, type, "Camera", std::move(params), loc);
    camera.cameraFromWorld = s.ctm;
    camera.startTime = s.startTime;
    camera.endTime = s.endTime;
    camera.medium = s.outsideMedium;
    units_.back().coordinateSystems["camera"] = {s.ctm.start.Inverse(), s.ctm.end.Inverse()};
    KeepReplaced(scene_.camera, "Camera");
    scene_.camera = std::move(camera);
}

void DescriptionBuilder::WorldBegin() {
    inWorld_ = true;
    GraphicsState &s = State();
    s.ctm = {};
    s.startActive = s.endActive = true;
    units_.back().coordinateSystems["world"] = s.ctm;
}

void DescriptionBuilder::CountFile(const FileLoc &loc) {
    constexpr size_t kMaxFiles = 20'000;
    if (++fileCount_ > kMaxFiles) throw UserError(loc, "More than {} files are included or imported.", kMaxFiles);
}

void DescriptionBuilder::OpenBlockAt(const FileLoc &loc, BlockKind kind) {
    constexpr size_t kMaxBlocks = size_t(1) << 17;
    Unit &unit = units_.back();
    if (unit.blocks.size() >= kMaxBlocks) throw UserError(loc, "Blocks are nested more than {} deep.", kMaxBlocks);
    unit.blocks.push_back({kind, loc, unit.state, unit.object});
}

void DescriptionBuilder::WarnTransformBlock(const FileLoc &loc) {
    if (std::exchange(warnedTransformBlock_, true)) return;
    sink_.Warning(loc, "TransformBegin and TransformEnd are deprecated; they mean AttributeBegin and AttributeEnd.");
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

bool DescriptionBuilder::IsFirst(std::map<std::string, FileLoc> &known, const char *kind, const GivenName &name) {
    auto [first, isNew] = known.try_emplace(name.text, name.loc);
    if (!isNew) sink_.Error(name.loc, "{} \"{}\" is defined twice{}.", kind, name.text, FirstDefinedAt(first->second));
    return isNew;
}

template <class E>
size_t DescriptionBuilder::PlaceOf(const GivenName &name, const char *kind, std::vector<E> &list,
                                   std::unordered_map<std::string, size_t> &index) {
    auto [place, isNew] = index.try_emplace(name.text, list.size());
    if (isNew) list.emplace_back();
    else
        sink_.Warning(name.loc, "{} \"{}\" is defined again by another file{}; the later definition is used.", kind,
                      name.text, FirstDefinedAt(list[place->second].loc));
    return place->second;
}

void DescriptionBuilder::BeginObject(const GivenName &name, const FileLoc &loc) {
    Unit &unit = units_.back();
    int object = kDiscard;
    if (unit.object != kNoObject) {
        sink_.Error(loc, "ObjectBegin \"{}\" inside another object definition.", name.text);
        object = unit.object;
    } else if (IsFirst(unit.objects, "Object", name)) {
        object = int(PlaceOf(name, "Object", scene_.objects, objectIndex_));
        scene_.objects[object] = {name.text, loc, {}};
    }
    OpenBlockAt(loc, BlockKind::Object);
    unit.object = object;
}

void DescriptionBuilder::AddInstance(const GivenName &name, const FileLoc &loc) {
    if (units_.back().object != kNoObject) {
        sink_.Error(loc, "ObjectInstance \"{}\" inside an object definition; instances do not nest.", name.text);
        return;
    }
    const GraphicsState &s = State();
    scene_.instances.push_back({name.text, name.loc, s.ctm, s.startTime, s.endTime});
}

void DescriptionBuilder::BeginImport() {
    Unit unit;
    unit.state = State();
    unit.object = units_.back().object;
    units_.push_back(std::move(unit));
}

void DescriptionBuilder::EndImport(bool complete) {
    if (complete) ReportOpenBlocks();
    units_.pop_back();
}

void DescriptionBuilder::ReportOpenBlocks() {
    for (const OpenBlock &b : units_.back().blocks)
        sink_.Error(b.loc, b.kind == BlockKind::Attributes ? "AttributeBegin without AttributeEnd."
                                                           : "ObjectBegin without ObjectEnd.");
}

void DescriptionBuilder::AddAttributes(AttributeTarget target, const std::string &name, Params params,
                                       const FileLoc &loc) {
    std::vector<Entity> &all = scene_.unbuilt[name];
    if (all.empty()) all.emplace_back().params = ParamSet(fmt::format("Attribute \"{}\"", name), loc);
    for (const Param &p : params) {
        Param declaration;
        declaration.type = p.type;
        declaration.name = p.name;
        declaration.loc = p.loc;
        all[0].params.Add(std::move(declaration));
    }
    auto &list = State().attributes[size_t(target)];
    // Copied at most once per scope, so that many directives in one scope take linear time.
    if (!list) list = std::make_shared<Params>();
    else if (list.use_count() > 1) list = std::make_shared<Params>(*list);
    std::move(params.begin(), params.end(), std::back_inserter(*list));
}

void DescriptionBuilder::SetColorSpace(const std::string &name, const FileLoc &loc) {
    static const std::vector<std::string> kNames = {"srgb", "dci-p3", "rec2020", "aces2065-1"};
    std::string lower = Lower(name);
    if (std::find(kNames.begin(), kNames.end(), lower) != kNames.end()) State().colorSpace = lower;
    else
        sink_.Warning(loc, "Unknown colour space \"{}\"; \"{}\" stays in force ({}).", name, State().colorSpace,
                      ListChoices(name, kNames));
}

void DescriptionBuilder::SetAreaLight(const std::string &type, Params params, const FileLoc &loc) {
    auto light = std::make_shared<PendingAreaLight>();
    Fill(light->entity, type, "AreaLightSource", std::move(params), loc, AttributeTarget::Light);
    State().areaLight = std::move(light);
}

TransformPair DescriptionBuilder::Unmoving(const char *what, const FileLoc &loc) {
    const TransformPair &ctm = State().ctm;
    if (ctm.IsAnimated())
        sink_.Warning(loc, "{} cannot be animated; the transformation at the start time is used.", what);
    return {ctm.start, ctm.start};
}

void DescriptionBuilder::AddMaterial(const std::string &type, Params params, const FileLoc &loc) {
    MaterialEntity material;
    Fill(material, type, "Material", std::move(params), loc, AttributeTarget::Material);
    State().material = {int(scene_.materials.size()), {}};
    scene_.materials.push_back(std::move(material));
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

void DescriptionBuilder::AddNamedMaterial(const GivenName &name, Params params, const FileLoc &loc) {
    MaterialEntity material;
    FillNamed(material, name.text, "MakeNamedMaterial", std::move(params), loc, AttributeTarget::Material);
    material.name = name.text;
    if (IsFirst(materialNames_, "Material", name)) scene_.materials.push_back(std::move(material));
}

void DescriptionBuilder::AddTexture(const GivenName &name, bool isSpectrum, const std::string &type, Params params,
                                    const FileLoc &loc) {
    if (!IsFirst(isSpectrum ? spectrumTextureNames_ : floatTextureNames_,
                 isSpectrum ? "Spectrum texture" : "Float texture", name))
        return;
    TextureEntity texture;
    Fill(texture, type, "Texture", std::move(params), loc, AttributeTarget::Texture);
    texture.name = name.text;
    texture.isSpectrum = isSpectrum;
    texture.ctm = Unmoving("A texture", loc);
    scene_.textures.push_back(std::move(texture));
}

void DescriptionBuilder::AddMedium(const GivenName &name, Params params, const FileLoc &loc) {
    MediumEntity medium;
    FillNamed(medium, name.text, "MakeNamedMedium", std::move(params), loc, AttributeTarget::Medium);
    medium.name = name.text;
    medium.ctm = Unmoving("A medium", loc);
    if (IsFirst(units_.back().media, "Medium", name))
        scene_.media[PlaceOf(name, "Medium", scene_.media, mediumIndex_)] = std::move(medium);
}

void DescriptionBuilder::AddLight(const std::string &type, Params params, const FileLoc &loc) {
    LightEntity light;
    Fill(light, type, "LightSource", std::move(params), loc, AttributeTarget::Light);
    light.ctm = Unmoving("A light", loc);
    light.medium = State().outsideMedium;
    if (units_.back().object != kNoObject)
        sink_.Warning(loc, "Lights are not instanced: this one shines once, from where the object is defined.");
    scene_.lights.push_back(std::move(light));
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

void DescriptionBuilder::FillDefaults(const FileLoc &where) {
    auto fill = [&](Entity &entity, const char *type, const char *directive) {
        if (entity.loc) return;  // given
        entity.type = type;
        entity.loc = where;
        entity.params = ParamSet(fmt::format("{} \"{}\"", directive, type), where);
    };
    fill(scene_.camera, "perspective", "Camera");
    fill(scene_.film, "rgb", "Film");
    fill(scene_.sampler, "zsobol", "Sampler");
    fill(scene_.filter, "gaussian", "PixelFilter");
    fill(scene_.integrator, "volpath", "Integrator");
    fill(scene_.accelerator, "bvh", "Accelerator");
}

/// ListChoices, or `none` if there are no names or the message will be dropped: lists are slow, and there may be many.
std::string DescriptionBuilder::ListNames(const std::string &given, const std::vector<std::string> &names,
                                          const char *none) const {
    return names.empty() || sink_.IsFull() ? none : ListChoices(given, names);
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
    std::vector<std::string> names;
    for (const auto &[name, loc] : materialNames_) names.push_back(name);
    for (const auto &[name, m] : missing)
        sink_.Error(m.firstUse, "This shape uses the named material \"{}\", which is not defined{}; {}.",
                    Abbreviate(name), m.shapes > 1 ? fmt::format(" (so do {} others)", m.shapes - 1) : "",
                    ListNames(name, names, "no material is"));
}

void DescriptionBuilder::CheckMedia() {
    std::set<std::string> reported;
    std::vector<std::string> names;
    for (const MediumEntity &m : scene_.media) names.push_back(m.name);
    auto check = [&](const std::string &name, const FileLoc &loc) {
        if (name.empty() || mediumIndex_.contains(name) || !reported.insert(name).second) return;
        sink_.Error(loc, "Medium \"{}\" is used here but not defined; {}.", Abbreviate(name),
                    ListNames(name, names, "no medium is"));
    };
    check(scene_.camera.medium, scene_.camera.loc);
    for (const LightEntity &light : scene_.lights) check(light.medium, light.loc);
    ForEachShape(scene_, [&](const ShapeEntity &shape) {
        check(shape.insideMedium, shape.loc);
        check(shape.outsideMedium, shape.loc);
    });
}

/// Reports instances of undefined objects; removes empty objects and their instances.
void DescriptionBuilder::ResolveInstances() {
    std::vector<std::string> names;
    for (const ObjectEntity &object : scene_.objects) names.push_back(object.name);
    std::set<std::string> reported;
    std::erase_if(scene_.instances, [&](const InstanceEntity &instance) {
        auto found = objectIndex_.find(instance.name);
        if (found != objectIndex_.end()) return scene_.objects[found->second].shapes.empty();
        if (!reported.insert(instance.name).second) return true;
        sink_.Error(instance.loc, "Object \"{}\" is not defined; {}.", Abbreviate(instance.name),
                    ListNames(instance.name, names, "no object is"));
        return true;
    });
    std::erase_if(scene_.objects, [](const ObjectEntity &object) { return object.shapes.empty(); });
}

SceneDescription DescriptionBuilder::Finish(bool complete, const FileLoc &where, FileResolver files) {
    FillDefaults(where);
    scene_.files = std::move(files);
    if (complete) {
        if (!inWorld_) sink_.Error(where, "The input ends before WorldBegin.");
        ReportOpenBlocks();
        CheckMaterials();
        CheckMedia();
        ResolveInstances();
    }
    return std::move(scene_);
}

}  // namespace pbrt
