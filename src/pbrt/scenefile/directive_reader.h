#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>

#include "pbrt/core/files.h"
#include "pbrt/scenefile/description_builder.h"
#include "pbrt/scenefile/parameter_reader.h"

namespace pbrt {

/// Grammar of scene files: reads directives from a tokenizer and calls the builder. One reader per top-level or
/// imported file.
class DirectiveReader {
  public:
    DirectiveReader(Tokenizer &tokens, DescriptionBuilder &builder, const FileResolver &files);

    /// Reads all tokens. Throws the first unrecoverable error.
    void Run();

  private:
    enum class Where { Anywhere, Options, World };
    struct Directive;
    static const std::unordered_map<std::string_view, Directive> &Directives();
    void SkipToNextDirective();
    void Unknown(const Token &word);

    void ReadAccelerator();
    void ReadActiveTransform();
    void ReadAreaLightSource();
    void ReadAttribute();
    void ReadAttributeBegin();
    void ReadAttributeEnd();
    void ReadCamera();
    void ReadColorSpace();
    void ReadConcatTransform();
    void ReadCoordinateSystem();
    void ReadCoordSysTransform();
    void ReadFilm();
    void ReadIdentity();
    void ReadImport();
    void ReadInclude();
    void ReadIntegrator();
    void ReadLightSource();
    void ReadLookAt();
    void ReadMakeNamedMaterial();
    void ReadMakeNamedMedium();
    void ReadMaterial();
    void ReadMediumInterface();
    void ReadNamedMaterial();
    void ReadObjectBegin();
    void ReadObjectEnd();
    void ReadObjectInstance();
    void ReadOption();
    void ReadPixelFilter();
    void ReadReverseOrientation();
    void ReadRotate();
    void ReadSampler();
    void ReadScale();
    void ReadShape();
    void ReadTexture();
    void ReadTransform();
    void ReadTransformBegin();
    void ReadTransformEnd();
    void ReadTransformTimes();
    void ReadTranslate();
    void ReadWorldBegin();

    std::string ReadType() { return std::string(arguments_.ReadString("a type name").text); }
    /// Reads a non-empty name; *loc is its location.
    std::string ReadName(const char *what, FileLoc *loc);
    Params ReadParams() { return arguments_.ReadList(builder_.State().colorSpace); }
    Vector3 ReadVector();
    Transform ReadMatrix();
    void SetOption(const std::string &name, const Token &token);
    /// Reads the file that the next token names. On failure, reports an error and returns null.
    std::shared_ptr<const SourceFile> ReadFile(std::string *key);

    Tokenizer &tokens_;
    DescriptionBuilder &builder_;
    const FileResolver &files_;
    ParameterReader arguments_;
    FileLoc here_;  ///< of the directive being read
    int unknownWords_ = 0;
};

/// Reads a file, or standard input for "-"; throws UserError (no location) on failure.
std::shared_ptr<const SourceFile> OpenSceneFile(const std::string &path, ReadFrom from = ReadFrom::Files);
/// Canonical key of a file, independent of how its name is written.
std::string SceneFileKey(const std::string &path);

}  // namespace pbrt
