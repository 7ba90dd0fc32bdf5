#pragma once
#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

/// A parameter list before it belongs to an entity.
using Params = std::vector<Param>;

struct GivenName {
    std::string text;
    FileLoc loc;
};

enum class AttributeTarget { Shape, Light, Material, Medium, Texture };
inline constexpr size_t AttributeTargetCount = 5;

/// An AreaLightSource directive, added to the description when the first shape uses it.
struct PendingAreaLight {
    Entity entity;
    int index = -1;
    bool warnedInObject = false;
};

/// State saved by AttributeBegin and restored by AttributeEnd (pbrt-v4-format §2.1).
struct GraphicsState : ShapeState {
    bool startActive = true, endActive = true;
    std::shared_ptr<PendingAreaLight> areaLight;
    std::string colorSpace = "srgb";
    /// Parameters of Attribute directives, one list per target. Copy-on-write: scopes may share a list, and only its
    /// sole owner may append (files are read by one thread).
    std::array<std::shared_ptr<Params>, AttributeTargetCount> attributes;
};

/// Executes directives: maintains the graphics state and fills the scene description, independently of the file's text.
/// Structural errors go to the sink; the offending directive then has no effect.
///
/// The scene's files share one Unit; every imported file has a nested one.
class DescriptionBuilder {
  public:
    explicit DescriptionBuilder(DiagnosticSink &sink) : sink_(sink) { units_.emplace_back(); }

    GraphicsState &State() { return units_.back().state; }
    bool InWorld() const { return inWorld_; }
    DiagnosticSink &Sink() { return sink_; }
    /// Reports a directive in the wrong block, once per word.
    void WrongBlock(std::string_view word, const FileLoc &loc) {
        if (!wrongBlockWords_.insert(std::string(word)).second) return;
        if (word == "WorldBegin") sink_.Error(loc, "WorldBegin was given before: a scene has one.");
        else
            sink_.Error(loc, inWorld_
                                 ? fmt::format("{} is not allowed after WorldBegin: it belongs to the options.", word)
                                 : fmt::format("{} is not allowed before WorldBegin.", word));
    }

    void Concat(const Transform &t, const FileLoc &loc) {
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
    void SetTransform(const Transform &t) {
        GraphicsState &s = State();
        if (s.startActive) s.ctm.start = t;
        if (s.endActive) s.ctm.end = t;
    }
    void DefineCoordinateSystem(const std::string &name) { units_.back().coordinateSystems[name] = State().ctm; }
    void UseCoordinateSystem(const GivenName &name) {
        const auto &known = units_.back().coordinateSystems;
        if (const auto found = known.find(name.text); found != known.end()) {
            State().ctm = found->second;
            return;
        }
        std::vector<std::string> names;
        for (const auto &[knownName, pair] : known) names.push_back(knownName);
        sink_.Warning(name.loc, "Coordinate system \"{}\" is not defined; the transformation stays as it is ({}).",
                      name.text, names.empty() ? "none is defined" : ListChoices(name.text, names));
    }

    SceneOptions &Options() { return scene_.options; }
    void SetCamera(const std::string &type, Params params, const FileLoc &loc) {
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
    /// For Film, Sampler, PixelFilter, Integrator and Accelerator.
    void SetEntity(Entity SceneDescription::*entity, const char *directive, const std::string &type, Params params,
                   const FileLoc &loc) {
        KeepReplaced(scene_.*entity, directive);
        Fill(scene_.*entity, type, directive, std::move(params), loc);
    }
    void WorldBegin() {
        inWorld_ = true;
        GraphicsState &s = State();
        s.ctm = {};
        s.startActive = s.endActive = true;
        units_.back().coordinateSystems["world"] = s.ctm;
    }

    /// Counts a file read at `loc`. Throws UserError above a limit that indicates recursive inclusion.
    void CountFile(const FileLoc &loc) {
        constexpr size_t kMaxFiles = 20'000;
        if (++fileCount_ > kMaxFiles) throw UserError(loc, "More than {} files are included or imported.", kMaxFiles);
    }
    void AddSource(const std::string &path) { scene_.sources.push_back(path); }

    void BeginAttributes(const FileLoc &loc) { OpenBlockAt(loc, BlockKind::Attributes); }
    void EndAttributes(const FileLoc &loc) { CloseBlock(BlockKind::Attributes, loc); }
    void WarnTransformBlock(const FileLoc &loc) {
        if (std::exchange(warnedTransformBlock_, true)) return;
        sink_.Warning(loc,
                      "TransformBegin and TransformEnd are deprecated; they mean AttributeBegin and AttributeEnd.");
    }
    void BeginObject(const GivenName &name, const FileLoc &loc) {
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
    void EndObject(const FileLoc &loc) { CloseBlock(BlockKind::Object, loc); }
    void AddInstance(const GivenName &name, const FileLoc &loc) {
        if (units_.back().object != kNoObject)
            return sink_.Error(loc, "ObjectInstance \"{}\" inside an object definition; instances do not nest.",
                               name.text);
        const GraphicsState &s = State();
        scene_.instances.push_back({name.text, name.loc, s.ctm, s.startTime, s.endTime});
    }
    void BeginImport() {
        Unit unit;
        unit.state = State();
        unit.object = units_.back().object;
        units_.push_back(std::move(unit));
    }
    /// Discards the unit's state. If `complete`, open blocks are errors; else parsing ended early.
    void EndImport(bool complete) {
        if (complete) ReportOpenBlocks();
        units_.pop_back();
    }

    void AddAttributes(AttributeTarget target, const std::string &name, Params params, const FileLoc &loc) {
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
    void SetColorSpace(const std::string &name, const FileLoc &loc) {
        static const std::vector<std::string> kNames = {"srgb", "dci-p3", "rec2020", "aces2065-1"};
        std::string lower = Lower(name);
        if (std::find(kNames.begin(), kNames.end(), lower) != kNames.end()) State().colorSpace = lower;
        else
            sink_.Warning(loc, "Unknown colour space \"{}\"; \"{}\" stays in force ({}).", name, State().colorSpace,
                          ListChoices(name, kNames));
    }
    void SetAreaLight(const std::string &type, Params params, const FileLoc &loc) {
        auto light = std::make_shared<PendingAreaLight>();
        Fill(light->entity, type, "AreaLightSource", std::move(params), loc, AttributeTarget::Light);
        State().areaLight = std::move(light);
    }

    void AddMaterial(const std::string &type, Params params, const FileLoc &loc) {
        MaterialEntity material;
        Fill(material, type, "Material", std::move(params), loc, AttributeTarget::Material);
        State().material = {int(scene_.materials.size()), {}};
        scene_.materials.push_back(std::move(material));
    }
    void AddNamedMaterial(const GivenName &name, Params params, const FileLoc &loc) {
        MaterialEntity material;
        FillNamed(material, name.text, "MakeNamedMaterial", std::move(params), loc, AttributeTarget::Material);
        material.name = name.text;
        if (IsFirst(materialNames_, "Material", name)) scene_.materials.push_back(std::move(material));
    }
    void AddTexture(const GivenName &name, bool isSpectrum, const std::string &type, Params params,
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
    void AddMedium(const GivenName &name, Params params, const FileLoc &loc) {
        MediumEntity medium;
        FillNamed(medium, name.text, "MakeNamedMedium", std::move(params), loc, AttributeTarget::Medium);
        medium.name = name.text;
        medium.ctm = Unmoving("A medium", loc);
        if (IsFirst(units_.back().media, "Medium", name))
            scene_.media[PlaceOf(name, "Medium", scene_.media, mediumIndex_)] = std::move(medium);
    }
    void AddLight(const std::string &type, Params params, const FileLoc &loc) {
        LightEntity light;
        Fill(light, type, "LightSource", std::move(params), loc, AttributeTarget::Light);
        light.ctm = Unmoving("A light", loc);
        light.medium = State().outsideMedium;
        if (units_.back().object != kNoObject)
            sink_.Warning(loc, "Lights are not instanced: this one shines once, from where the object is defined.");
        scene_.lights.push_back(std::move(light));
    }
    void AddShape(const std::string &type, Params params, const FileLoc &loc);

    /// Returns the scene, after whole-scene checks if `complete`. `where`: of errors that belong to no directive.
    SceneDescription Finish(bool complete, const FileLoc &where, FileResolver files) {
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

  private:
    enum class BlockKind { Attributes, Object };
    struct OpenBlock {
        BlockKind kind;
        FileLoc loc;
        GraphicsState saved;
        int outerObject;
    };
    struct Unit {
        GraphicsState state;
        std::vector<OpenBlock> blocks;
        std::map<std::string, TransformPair> coordinateSystems;
        std::map<std::string, FileLoc> objects, media;  ///< defined by this unit: redefinition is an error
        int object = kNoObject;
    };
    /// Unit::object is an index into scene_.objects, or one of these: outside objects, inside a discarded object.
    static constexpr int kNoObject = -1, kDiscard = -2;

    void Fill(Entity &entity, const std::string &type, const char *directive, Params params, const FileLoc &loc,
              std::optional<AttributeTarget> target = {}) const;
    void KeepReplaced(Entity &entity, const char *directive) {
        if (entity.loc) scene_.unbuilt[directive].push_back(std::move(entity));
    }
    /// Fill for a named entity, whose type is its parameter "string type".
    void FillNamed(Entity &entity, const std::string &name, const char *directive, Params params, const FileLoc &loc,
                   AttributeTarget target);
    /// "; it was first defined at FILE:LINE", or "" if the location is unknown.
    static std::string FirstDefinedAt(const FileLoc &loc) {
        return loc ? fmt::format("; it was first defined at {}:{}", loc.file->name, loc.line) : std::string();
    }
    /// Records a definition in `known`. If the name is defined already, reports an error and returns false.
    bool IsFirst(std::map<std::string, FileLoc> &known, const char *kind, const GivenName &name) {
        auto [first, isNew] = known.try_emplace(name.text, name.loc);
        if (!isNew)
            sink_.Error(name.loc, "{} \"{}\" is defined twice{}.", kind, name.text, FirstDefinedAt(first->second));
        return isNew;
    }
    /// Index in `list` of a new entity, or with a warning of the one of that name, which it replaces.
    template <class E>
    size_t PlaceOf(const GivenName &name, const char *kind, std::vector<E> &list,
                   std::unordered_map<std::string, size_t> &index) {
        auto [place, isNew] = index.try_emplace(name.text, list.size());
        if (isNew) list.emplace_back();
        else
            sink_.Warning(name.loc, "{} \"{}\" is defined again by another file{}; the later definition is used.", kind,
                          name.text, FirstDefinedAt(list[place->second].loc));
        return place->second;
    }
    /// CTM pair of an entity that cannot be animated: the start transform, with a warning if the two differ.
    TransformPair Unmoving(const char *what, const FileLoc &loc) {
        const TransformPair &ctm = State().ctm;
        if (ctm.IsAnimated())
            sink_.Warning(loc, "{} cannot be animated; the transformation at the start time is used.", what);
        return {ctm.start, ctm.start};
    }
    void OpenBlockAt(const FileLoc &loc, BlockKind kind) {
        constexpr size_t kMaxBlocks = size_t(1) << 17;
        Unit &unit = units_.back();
        if (unit.blocks.size() >= kMaxBlocks) throw UserError(loc, "Blocks are nested more than {} deep.", kMaxBlocks);
        unit.blocks.push_back({kind, loc, unit.state, unit.object});
    }
    void CloseBlock(BlockKind kind, const FileLoc &loc);
    void ReportOpenBlocks() {
        for (const OpenBlock &b : units_.back().blocks)
            sink_.Error(b.loc, b.kind == BlockKind::Attributes ? "AttributeBegin without AttributeEnd."
                                                               : "ObjectBegin without ObjectEnd.");
    }
    void FillDefaults(const FileLoc &where) {
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
    void CheckMaterials();
    void CheckMedia();
    /// Reports instances of undefined objects; removes empty objects and their instances.
    void ResolveInstances() {
        std::vector<std::string> names;
        for (const ObjectEntity &object : scene_.objects) names.push_back(object.name);
        std::set<std::string> reported;
        std::erase_if(scene_.instances, [&](const InstanceEntity &instance) {
            auto found = objectIndex_.find(instance.name);
            if (found != objectIndex_.end()) return scene_.objects[found->second].shapes.empty();
            if (!reported.insert(instance.name).second) return true;
            sink_.Error(instance.loc, "Object \"{}\" is not defined; {}.", Abbreviate(instance.name),
                        ListNames(sink_, instance.name, names, "no object is"));
            return true;
        });
        std::erase_if(scene_.objects, [](const ObjectEntity &object) { return object.shapes.empty(); });
    }

    DiagnosticSink &sink_;
    SceneDescription scene_;
    std::vector<Unit> units_;
    size_t fileCount_ = 0;
    bool inWorld_ = false, warnedTransformBlock_ = false;
    std::set<std::string, std::less<>> wrongBlockWords_;
    std::map<std::string, FileLoc> materialNames_, floatTextureNames_, spectrumTextureNames_;
    std::unordered_map<std::string, size_t> objectIndex_, mediumIndex_;
};

}  // namespace pbrt
