#include "pbrt/scenefile/directive_reader.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "pbrt/core/limits.h"
#include "pbrt/core/v3_names.h"

namespace pbrt {

struct DirectiveReader::Directive {
    Where where;
    void (DirectiveReader::*read)();
};

DirectiveReader::DirectiveReader(Tokenizer &tokens, DescriptionBuilder &builder, const FileResolver &files)
    : tokens_(tokens), builder_(builder), files_(files), arguments_(tokens, builder.Sink()) {}

const std::unordered_map<std::string_view, DirectiveReader::Directive> &DirectiveReader::Directives() {
    using D = DirectiveReader;
    static const std::unordered_map<std::string_view, Directive> directives = {
        {"Accelerator", {Where::Options, &D::ReadAccelerator}},
        {"ActiveTransform", {Where::Anywhere, &D::ReadActiveTransform}},
        {"AreaLightSource", {Where::World, &D::ReadAreaLightSource}},
        {"Attribute", {Where::Anywhere, &D::ReadAttribute}},
        {"AttributeBegin", {Where::World, &D::ReadAttributeBegin}},
        {"AttributeEnd", {Where::World, &D::ReadAttributeEnd}},
        {"Camera", {Where::Options, &D::ReadCamera}},
        {"ColorSpace", {Where::Anywhere, &D::ReadColorSpace}},
        {"ConcatTransform", {Where::Anywhere, &D::ReadConcatTransform}},
        {"CoordinateSystem", {Where::Anywhere, &D::ReadCoordinateSystem}},
        {"CoordSysTransform", {Where::Anywhere, &D::ReadCoordSysTransform}},
        {"Film", {Where::Options, &D::ReadFilm}},
        {"Identity", {Where::Anywhere, &D::ReadIdentity}},
        {"Import", {Where::World, &D::ReadImport}},
        {"Include", {Where::Anywhere, &D::ReadInclude}},
        {"Integrator", {Where::Options, &D::ReadIntegrator}},
        {"LightSource", {Where::World, &D::ReadLightSource}},
        {"LookAt", {Where::Anywhere, &D::ReadLookAt}},
        {"MakeNamedMaterial", {Where::World, &D::ReadMakeNamedMaterial}},
        {"MakeNamedMedium", {Where::Anywhere, &D::ReadMakeNamedMedium}},
        {"Material", {Where::World, &D::ReadMaterial}},
        {"MediumInterface", {Where::Anywhere, &D::ReadMediumInterface}},
        {"NamedMaterial", {Where::World, &D::ReadNamedMaterial}},
        {"ObjectBegin", {Where::World, &D::ReadObjectBegin}},
        {"ObjectEnd", {Where::World, &D::ReadObjectEnd}},
        {"ObjectInstance", {Where::World, &D::ReadObjectInstance}},
        {"Option", {Where::Anywhere, &D::ReadOption}},
        {"PixelFilter", {Where::Options, &D::ReadPixelFilter}},
        {"ReverseOrientation", {Where::World, &D::ReadReverseOrientation}},
        {"Rotate", {Where::Anywhere, &D::ReadRotate}},
        {"Sampler", {Where::Options, &D::ReadSampler}},
        {"Scale", {Where::Anywhere, &D::ReadScale}},
        {"Shape", {Where::World, &D::ReadShape}},
        {"Texture", {Where::World, &D::ReadTexture}},
        {"Transform", {Where::Anywhere, &D::ReadTransform}},
        {"TransformBegin", {Where::World, &D::ReadTransformBegin}},
        {"TransformEnd", {Where::World, &D::ReadTransformEnd}},
        {"TransformTimes", {Where::Options, &D::ReadTransformTimes}},
        {"Translate", {Where::Anywhere, &D::ReadTranslate}},
        {"WorldBegin", {Where::Options, &D::ReadWorldBegin}},
    };
    return directives;
}

void DirectiveReader::Run() {
    for (;;) {
        Token word = tokens_.Next();
        if (word.kind == TokenKind::End) return;
        bool isNumber = word.text.find_first_of("0123456789+-.") == 0;
        if (word.kind != TokenKind::Word || isNumber)
            arguments_.Fail(word, fmt::format("Expected a directive, found {0}{1}{0}{2}.",
                                              word.kind == TokenKind::String ? "\"" : "", Abbreviate(word.text),
                                              isNumber ? " (several values need [ ] around them)" : ""));
        auto found = Directives().find(word.text);
        if (found == Directives().end()) {
            Unknown(word);
            continue;
        }
        here_ = tokens_.Loc(word);
        const Directive &directive = found->second;
        if (directive.where == Where::Anywhere || (directive.where == Where::World) == builder_.InWorld()) {
            (this->*directive.read)();
        } else {
            builder_.WrongBlock(word.text, here_);
            SkipToNextDirective();
        }
    }
}

/// Skips values and parameter lists up to the next word, which begins a directive.
void DirectiveReader::SkipToNextDirective() {
    for (;;) {
        const Token &token = tokens_.Peek();
        if (token.kind == TokenKind::End) return;
        if (token.kind == TokenKind::Word && std::isalpha(static_cast<unsigned char>(token.text[0])) &&
            token.text != "true" && token.text != "false")
            return;
        tokens_.Next();
    }
}

void DirectiveReader::Unknown(const Token &word) {
    std::vector<std::string> words;
    for (const auto &[known, directive] : Directives()) words.emplace_back(known);
    std::sort(words.begin(), words.end());
    const std::string shown = Abbreviate(word.text);
    std::string message =
        fmt::format("Unknown directive: {}; {}{}.", shown, V3Hint("directive", shown), ListChoices(shown, words));
    constexpr int kMax = 5;
    if (++unknownWords_ == kMax) arguments_.Fail(word, message + " Too many unknown directives: giving up here.");
    builder_.Sink().Error(tokens_.Loc(word), message);
    SkipToNextDirective();
}

std::string DirectiveReader::ReadName(const char *what, FileLoc *loc) {
    Token token = arguments_.ReadString(what);
    if (loc) *loc = tokens_.Loc(token);
    if (token.text.empty()) builder_.Sink().Error(tokens_.Loc(token), fmt::format("{} must not be empty.", what));
    return arguments_.NameOf(token);
}

Vector3 DirectiveReader::ReadVector() {
    Vector3 v;
    for (int i = 0; i < 3; ++i) v[i] = arguments_.ReadFloat("a number");
    return v;
}

Transform DirectiveReader::ReadMatrix() {
    Token open = arguments_.Require("[");
    if (open.kind != TokenKind::Open) arguments_.Fail(open, "Expected [ and 16 numbers.");
    std::array<Float, 16> values;
    for (Float &v : values) v = arguments_.ReadFloat("one of the 16 numbers of a matrix");
    Token close = arguments_.Require("]");
    if (close.kind != TokenKind::Close) arguments_.Fail(close, "Expected ] after the 16 numbers of a matrix.");
    Transform t = Transform::FromFile(values);
    if (t.IsSingular())
        builder_.Sink().Warning(here_, "This matrix cannot be inverted: it flattens what it transforms.");
    return t;
}

void DirectiveReader::ReadIdentity() { builder_.SetTransform(Transform()); }
void DirectiveReader::ReadTransform() { builder_.SetTransform(ReadMatrix()); }
void DirectiveReader::ReadConcatTransform() { builder_.Concat(ReadMatrix(), here_); }
void DirectiveReader::ReadTranslate() { builder_.Concat(Transform::Translate(ReadVector()), here_); }

void DirectiveReader::ReadScale() {
    Vector3 s = ReadVector();
    if (s.x == 0 || s.y == 0 || s.z == 0)
        builder_.Sink().Warning(here_, "A scale of 0 cannot be inverted: it flattens what it transforms.");
    builder_.Concat(Transform::Scale(s), here_);
}

void DirectiveReader::ReadRotate() {
    Float degrees = arguments_.ReadFloat("an angle in degrees");
    Vector3 axis = ReadVector();
    const Float size = MaxComponent(Abs(axis));
    if (size > 0)  // the squared length of a very long or short axis would overflow or underflow
        builder_.Concat(Transform::Rotate(degrees, axis / size), here_);
    else builder_.Sink().Error(here_, "Rotate: the axis has length zero.");
}

void DirectiveReader::ReadLookAt() {
    Point3 eye = ReadVector(), look = ReadVector();
    Vector3 up = ReadVector();
    if (auto view = Transform::LookAt(eye, look, up)) builder_.Concat(*view, here_);
    else
        builder_.Sink().Error(here_,
                              "LookAt: the eye and the point looked at are the same, or up is parallel to the view.");
}

void DirectiveReader::ReadCoordinateSystem() {
    builder_.DefineCoordinateSystem(ReadName("A coordinate system name", nullptr));
}

void DirectiveReader::ReadCoordSysTransform() {
    FileLoc loc;
    std::string name = ReadName("A coordinate system name", &loc);
    builder_.UseCoordinateSystem(name, loc);
}

void DirectiveReader::ReadActiveTransform() {
    Token word = arguments_.ReadWord("All, StartTime or EndTime");
    bool all = word.text == "All";
    if (!all && word.text != "StartTime" && word.text != "EndTime")
        arguments_.Fail(word, fmt::format("Unknown word \"{}\" after ActiveTransform; {}.", Abbreviate(word.text),
                                          ListChoices(word.text, {"All", "StartTime", "EndTime"})));
    builder_.State().startActive = all || word.text == "StartTime";
    builder_.State().endActive = all || word.text == "EndTime";
}

void DirectiveReader::ReadTransformTimes() {
    builder_.State().startTime = arguments_.ReadFloat("the start time");
    builder_.State().endTime = arguments_.ReadFloat("the end time");
}

void DirectiveReader::ReadCamera() {
    std::string type = ReadType();
    builder_.SetCamera(type, ReadParams(), here_);
}

void DirectiveReader::ReadFilm() {
    std::string type = ReadType();
    builder_.SetFilm(type, ReadParams(), here_);
}

void DirectiveReader::ReadSampler() {
    std::string type = ReadType();
    builder_.SetSampler(type, ReadParams(), here_);
}

void DirectiveReader::ReadPixelFilter() {
    std::string type = ReadType();
    builder_.SetFilter(type, ReadParams(), here_);
}

void DirectiveReader::ReadIntegrator() {
    std::string type = ReadType();
    builder_.SetIntegrator(type, ReadParams(), here_);
}

void DirectiveReader::ReadAccelerator() {
    std::string type = ReadType();
    builder_.SetAccelerator(type, ReadParams(), here_);
}

void DirectiveReader::ReadWorldBegin() { builder_.WorldBegin(); }

void DirectiveReader::ReadOption() {
    Token token = arguments_.ReadString("an option name");
    std::string name;
    for (char c : token.text)
        if (c != '-' && c != '_') name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    SetOption(name, token);
}

void DirectiveReader::SetOption(const std::string &name, const Token &token) {
    SceneOptions &options = builder_.Options();
    static const std::map<std::string, std::optional<bool> SceneOptions::*> kSwitches = {
        {"disablepixeljitter", &SceneOptions::disablePixelJitter},
        {"disabletexturefiltering", &SceneOptions::disableTextureFiltering},
        {"disablewavelengthjitter", &SceneOptions::disableWavelengthJitter},
        {"forcediffuse", &SceneOptions::forceDiffuse},
        {"pixelstats", &SceneOptions::pixelStats},
        {"wavefront", &SceneOptions::wavefront}};
    if (auto found = kSwitches.find(name); found != kSwitches.end()) {
        options.*found->second = arguments_.ReadBool("a value of this option");
        if (name == "pixelstats" && *options.pixelStats)
            builder_.Sink().Warning(tokens_.Loc(token), "no images of statistics per pixel are written.");
    } else if (name == "displacementedgescale") {
        const Float scale = arguments_.ReadFloat("a number");
        options.displacementEdgeScale = scale;
        if (!(scale > 0))
            builder_.Sink().Error(tokens_.Loc(token),
                                  fmt::format("\"{}\" is {}; it must be above 0.", token.text, scale));
    } else if (name == "seed") {
        options.seed = arguments_.ReadInt("a seed");
    } else if (name == "msereferenceimage") {
        options.mseReferenceImage = arguments_.ReadString("a file name").text;
    } else if (name == "msereferenceout") {
        options.mseReferenceOut = arguments_.ReadString("a file name").text;
    } else if (name == "rendercoordsys") {
        Token value = arguments_.ReadString("a coordinate system");
        static const std::vector<std::string> kSystems = {"camera", "cameraworld", "world"};
        if (std::find(kSystems.begin(), kSystems.end(), value.text) != kSystems.end())
            options.renderCoordSys = value.text;
        else
            builder_.Sink().Error(tokens_.Loc(value),
                                  fmt::format("Unknown rendering coordinate system \"{}\"; {}.", Abbreviate(value.text),
                                              ListChoices(value.text, kSystems)));
    } else {
        std::vector<std::string> names = {"displacementedgescale", "msereferenceimage", "msereferenceout",
                                          "rendercoordsys", "seed"};
        for (const auto &[switchName, member] : kSwitches) names.push_back(switchName);
        builder_.Sink().Error(tokens_.Loc(token), fmt::format("Unknown option \"{}\"; {}.", Abbreviate(token.text),
                                                              ListChoices(name, names)));
        SkipToNextDirective();
    }
}

void DirectiveReader::ReadAttributeBegin() { builder_.BeginAttributes(here_); }
void DirectiveReader::ReadAttributeEnd() { builder_.EndAttributes(here_); }

void DirectiveReader::ReadTransformBegin() {
    builder_.WarnTransformBlock(here_);
    builder_.BeginAttributes(here_);
}

void DirectiveReader::ReadTransformEnd() {
    builder_.WarnTransformBlock(here_);
    builder_.EndAttributes(here_);
}

void DirectiveReader::ReadAttribute() {
    static const std::vector<std::string> kTargets = {"shape", "light", "material", "medium", "texture"};
    Token target = arguments_.ReadString("an attribute target");
    auto found = std::find(kTargets.begin(), kTargets.end(), target.text);
    Params params = ReadParams();
    if (found != kTargets.end())
        builder_.AddAttributes(static_cast<AttributeTarget>(found - kTargets.begin()), std::move(params));
    else
        builder_.Sink().Error(tokens_.Loc(target),
                              fmt::format("Unknown attribute target \"{}\"; {}.", Abbreviate(target.text),
                                          ListChoices(target.text, kTargets)));
}

void DirectiveReader::ReadColorSpace() {
    Token name = arguments_.ReadString("a colour space name");
    builder_.SetColorSpace(std::string(name.text), tokens_.Loc(name));
}

void DirectiveReader::ReadMediumInterface() {
    GraphicsState &state = builder_.State();
    state.insideMedium = arguments_.NameOf(arguments_.ReadString("a medium name"));
    state.outsideMedium = state.insideMedium;
    if (tokens_.Peek().kind == TokenKind::String) state.outsideMedium = arguments_.NameOf(tokens_.Next());
}

void DirectiveReader::ReadReverseOrientation() {
    builder_.State().reverseOrientation = !builder_.State().reverseOrientation;
}

void DirectiveReader::ReadAreaLightSource() {
    std::string type = ReadType();
    builder_.SetAreaLight(type, ReadParams(), here_);
}

void DirectiveReader::ReadMaterial() {
    std::string type = ReadType();
    builder_.AddMaterial(type, ReadParams(), here_);
}

void DirectiveReader::ReadNamedMaterial() {
    std::string name = ReadName("A material name", nullptr);
    builder_.State().material = {-1, std::move(name)};
}

void DirectiveReader::ReadMakeNamedMaterial() {
    FileLoc loc;
    std::string name = ReadName("A material name", &loc);
    builder_.AddNamedMaterial(name, ReadParams(), here_, loc);
}

void DirectiveReader::ReadMakeNamedMedium() {
    FileLoc loc;
    std::string name = ReadName("A medium name", &loc);
    builder_.AddMedium(name, ReadParams(), here_, loc);
}

void DirectiveReader::ReadTexture() {
    FileLoc loc;
    std::string name = ReadName("A texture name", &loc);
    Token family = arguments_.ReadString("\"float\" or \"spectrum\"");
    std::string type(arguments_.ReadString("a texture class").text);
    Params params = ReadParams();
    if (family.text == "float" || family.text == "spectrum")
        builder_.AddTexture(name, family.text == "spectrum", type, std::move(params), here_, loc);
    else
        builder_.Sink().Error(
            tokens_.Loc(family),
            fmt::format("Unknown kind of texture \"{}\"; {}{}.", Abbreviate(family.text),
                        V3Hint("kind of texture", family.text), ListChoices(family.text, {"float", "spectrum"})));
}

void DirectiveReader::ReadLightSource() {
    std::string type = ReadType();
    builder_.AddLight(type, ReadParams(), here_);
}

void DirectiveReader::ReadShape() {
    std::string type = ReadType();
    builder_.AddShape(type, ReadParams(), here_);
}

void DirectiveReader::ReadObjectBegin() {
    FileLoc loc;
    std::string name = ReadName("An object name", &loc);
    builder_.BeginObject(name, here_, loc);
}

void DirectiveReader::ReadObjectEnd() { builder_.EndObject(here_); }

void DirectiveReader::ReadObjectInstance() {
    FileLoc loc;
    std::string name = ReadName("An object name", &loc);
    builder_.AddInstance(name, here_, loc);
}

std::shared_ptr<const SourceFile> DirectiveReader::ReadFile(std::string *key) {
    Token token = arguments_.ReadString("a file name");
    FileLoc loc = tokens_.Loc(token);
    std::string name(token.text);
    std::string path = name == "-" ? name : files_.Resolve(name);
    builder_.CountFile(loc);
    if (tokens_.Depth() >= kMaxNesting)
        throw UserError(fmt::format("{}: files are nested more than {} deep.", Abbreviate(path), kMaxNesting), loc);
    try {
        std::string wanted = SceneFileKey(path);
        if (tokens_.IsOpen(wanted)) throw UserError(fmt::format("{}: the file reads itself.", path));
        *key = wanted;
        return OpenSceneFile(path);
    } catch (const UserError &e) {
        for (const Diagnostic &d : e.Diagnostics()) builder_.Sink().Error(loc, d.message);
        return nullptr;
    }
}

void DirectiveReader::ReadInclude() {
    std::string key;
    if (auto file = ReadFile(&key)) tokens_.Push(std::move(file), std::move(key));
}

/// Unlike stock pbrt-v4, which imports files in parallel, imports sequentially for determinism.
void DirectiveReader::ReadImport() {
    std::string key;
    auto file = ReadFile(&key);
    if (!file) return;
    builder_.BeginImport();
    Tokenizer tokens(&tokens_);
    bool complete = false;
    try {
        tokens.Push(std::move(file), std::move(key));
        DirectiveReader(tokens, builder_, files_).Run();
        complete = true;
    } catch (const UserError &e) {
        builder_.Sink().Add(e);
    }
    builder_.EndImport(complete);
}

std::string SceneFileKey(const std::string &path) {
    std::error_code ignored;
    std::filesystem::path key = std::filesystem::weakly_canonical(path, ignored);
    return ignored || path == "-" ? path : key.string();
}

std::shared_ptr<const SourceFile> OpenSceneFile(const std::string &path, ReadFrom from) {
    if (path != "-") return std::make_shared<SourceFile>(SourceFile{path, ReadFileContents(path, from)});
    std::string text;
    std::array<char, 1 << 16> buffer;
    for (;;) {
        ssize_t got = read(STDIN_FILENO, buffer.data(), buffer.size());
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw UserError(fmt::format("Standard input: {}.", std::strerror(errno)));
        if (got == 0) break;
        text.append(buffer.data(), static_cast<size_t>(got));
    }
    return std::make_shared<SourceFile>(SourceFile{"<stdin>", std::move(text)});
}

}  // namespace pbrt
