#pragma once
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

/// A parameter list before it belongs to an entity.
using Params = std::vector<Param>;

/// A name as given in the scene.
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
    void WrongBlock(std::string_view word, const FileLoc &loc);

    void Concat(const Transform &t, const FileLoc &loc);
    void SetTransform(const Transform &t);
    void DefineCoordinateSystem(const std::string &name) { units_.back().coordinateSystems[name] = State().ctm; }
    void UseCoordinateSystem(const GivenName &name);

    SceneOptions &Options() { return scene_.options; }
    void SetCamera(const std::string &type, Params params, const FileLoc &loc);
    /// For Film, Sampler, PixelFilter, Integrator and Accelerator.
    void SetEntity(Entity SceneDescription::*entity, const char *directive, const std::string &type, Params params,
                   const FileLoc &loc) {
        KeepReplaced(scene_.*entity, directive);
        Fill(scene_.*entity, type, directive, std::move(params), loc);
    }
    void WorldBegin();

    /// Counts a file read at `loc`. Throws UserError above a limit that indicates recursive inclusion.
    void CountFile(const FileLoc &loc);
    void AddSource(const std::string &path) { scene_.sources.push_back(path); }

    void BeginAttributes(const FileLoc &loc) { OpenBlockAt(loc, BlockKind::Attributes); }
    void EndAttributes(const FileLoc &loc) { CloseBlock(BlockKind::Attributes, loc); }
    void WarnTransformBlock(const FileLoc &loc);
    void BeginObject(const GivenName &name, const FileLoc &loc);
    void EndObject(const FileLoc &loc) { CloseBlock(BlockKind::Object, loc); }
    void AddInstance(const GivenName &name, const FileLoc &loc);
    void BeginImport();
    /// Discards the unit's state. If `complete`, open blocks are errors; else parsing ended early.
    void EndImport(bool complete);

    void AddAttributes(AttributeTarget target, const std::string &name, Params params, const FileLoc &loc);
    void SetColorSpace(const std::string &name, const FileLoc &loc);
    void SetAreaLight(const std::string &type, Params params, const FileLoc &loc);

    void AddMaterial(const std::string &type, Params params, const FileLoc &loc);
    void AddNamedMaterial(const GivenName &name, Params params, const FileLoc &loc);
    void AddTexture(const GivenName &name, bool isSpectrum, const std::string &type, Params params, const FileLoc &loc);
    void AddMedium(const GivenName &name, Params params, const FileLoc &loc);
    void AddLight(const std::string &type, Params params, const FileLoc &loc);
    void AddShape(const std::string &type, Params params, const FileLoc &loc);

    /// Returns the scene, after whole-scene checks if `complete`. `where`: of errors that belong to no directive.
    SceneDescription Finish(bool complete, const FileLoc &where, FileResolver files);

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
    /// Records a definition in `known`. If the name is defined already, reports an error and returns false.
    bool IsFirst(std::map<std::string, FileLoc> &known, const char *kind, const GivenName &name);
    /// Index in `list` of a new entity, or with a warning of the one of that name, which it replaces.
    template <class E>
    size_t PlaceOf(const GivenName &name, const char *kind, std::vector<E> &list,
                   std::unordered_map<std::string, size_t> &index);
    /// CTM pair of an entity that cannot be animated: the start transform, with a warning if the two differ.
    TransformPair Unmoving(const char *what, const FileLoc &loc);
    void OpenBlockAt(const FileLoc &loc, BlockKind kind);
    void CloseBlock(BlockKind kind, const FileLoc &loc);
    void ReportOpenBlocks();
    void FillDefaults(const FileLoc &where);
    std::string ListNames(const std::string &given, const std::vector<std::string> &names, const char *none) const;
    void CheckMaterials();
    void CheckMedia();
    void ResolveInstances();

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
