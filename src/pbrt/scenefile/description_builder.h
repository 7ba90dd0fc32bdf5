#pragma once
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "pbrt/scenefile/graphics_state.h"

namespace pbrt {

/// A parameter list before it belongs to an entity.
using Params = std::vector<Param>;

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
    void DefineCoordinateSystem(const std::string &name);
    void UseCoordinateSystem(const std::string &name, const FileLoc &loc);

    SceneOptions &Options() { return scene_.options; }
    void SetCamera(const std::string &type, Params params, const FileLoc &loc);
    void SetFilm(const std::string &type, Params params, const FileLoc &loc);
    void SetSampler(const std::string &type, Params params, const FileLoc &loc);
    void SetFilter(const std::string &type, Params params, const FileLoc &loc);
    void SetIntegrator(const std::string &type, Params params, const FileLoc &loc);
    void SetAccelerator(const std::string &type, Params params, const FileLoc &loc);
    void WorldBegin();

    /// Counts a file read at `loc`. Throws UserError above a limit that indicates recursive inclusion.
    void CountFile(const FileLoc &loc);

    void BeginAttributes(const FileLoc &loc);
    void EndAttributes(const FileLoc &loc);
    void WarnTransformBlock(const FileLoc &loc);
    void BeginObject(const std::string &name, const FileLoc &loc, const FileLoc &nameLoc);
    void EndObject(const FileLoc &loc);
    void AddInstance(const std::string &name, const FileLoc &loc, const FileLoc &nameLoc);
    void BeginImport();
    /// Discards the unit's state. If `complete`, open blocks are errors; else parsing ended early.
    void EndImport(bool complete);

    void AddAttributes(AttributeTarget target, Params params);
    void SetColorSpace(const std::string &name, const FileLoc &loc);
    void SetAreaLight(const std::string &type, Params params, const FileLoc &loc);

    void AddMaterial(const std::string &type, Params params, const FileLoc &loc);
    void AddNamedMaterial(const std::string &name, Params params, const FileLoc &loc, const FileLoc &nameLoc);
    void AddTexture(const std::string &name, bool isSpectrum, const std::string &type, Params params,
                    const FileLoc &loc, const FileLoc &nameLoc);
    void AddMedium(const std::string &name, Params params, const FileLoc &loc, const FileLoc &nameLoc);
    void AddLight(const std::string &type, Params params, const FileLoc &loc);
    void AddShape(const std::string &type, Params params, const FileLoc &loc);

    /// Returns the scene, after whole-scene checks if `complete`. `where`: file location of errors that belong to no
    /// directive.
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

    ParamSet MakeParams(std::string what, Params params, const FileLoc &loc,
                        std::optional<AttributeTarget> target) const;
    void Fill(Entity &entity, const std::string &type, const char *directive, Params params, const FileLoc &loc,
              std::optional<AttributeTarget> target = {}) const;
    /// Fill for a named entity, whose type is its parameter "string type".
    void FillNamed(Entity &entity, const std::string &name, const char *directive, Params params, const FileLoc &loc,
                   AttributeTarget target);
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
    bool hasCamera_ = false, hasFilm_ = false, hasSampler_ = false, hasFilter_ = false, hasIntegrator_ = false,
         hasAccelerator_ = false;
    std::set<std::string, std::less<>> wrongBlockWords_;
    std::map<std::string, FileLoc> materialNames_, floatTextureNames_, spectrumTextureNames_;
    std::unordered_map<std::string, size_t> objectIndex_, mediumIndex_;
};

const std::vector<std::string> &ColorSpaceNames();

}  // namespace pbrt
