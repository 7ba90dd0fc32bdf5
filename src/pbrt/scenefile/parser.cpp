#include "pbrt/scenefile/parser.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <unordered_map>
#include <utility>

#include "pbrt/scenefile/parameter_reader.h"

namespace pbrt {
namespace {

/// Canonical key of a file, independent of how its name is written.
std::string SceneFileKey(const std::string &path) {
    std::error_code ignored;
    std::filesystem::path key = std::filesystem::weakly_canonical(path, ignored);
    return ignored || path == "-" ? path : key.string();
}

/// Reads a file, or standard input for "-"; throws UserError (no location) on failure.
std::shared_ptr<const SourceFile> OpenSceneFile(const std::string &path, ReadFrom from = ReadFrom::Files) {
    if (path != "-") return std::make_shared<SourceFile>(SourceFile{path, ReadFileContents(path, from)});
    std::string text;
    std::array<char, 1 << 16> buffer;
    for (;;) {
        ssize_t got = read(STDIN_FILENO, buffer.data(), buffer.size());
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw UserError("Standard input: {}.", std::strerror(errno));
        if (got == 0) break;
        text.append(buffer.data(), got);
    }
    return std::make_shared<SourceFile>(SourceFile{"<stdin>", std::move(text)});
}

/// Grammar of scene files: one reader per top-level or imported file.
class DirectiveReader {
  public:
    DirectiveReader(Tokenizer &tokens, DescriptionBuilder &builder, const FileResolver &files)
        : tokens_(tokens), builder_(builder), files_(files), arguments_(tokens, builder.Sink()) {}

    /// Reads all tokens. Throws the first unrecoverable error.
    void Run() {
        for (;;) {
            Token word = tokens_.Next();
            if (word.kind == TokenKind::End) return;
            bool isNumber = word.text.find_first_of("0123456789+-.") == 0;
            if (word.kind != TokenKind::Word || isNumber)
                arguments_.Fail(word, "Expected a directive, found {0}{1}{0}{2}.",
                                word.kind == TokenKind::String ? "\"" : "", Abbreviate(word.text),
                                isNumber ? " (several values need [ ] around them)" : "");
            auto found = Directives().find(word.text);
            if (found == Directives().end()) {
                Unknown(word);
                continue;
            }
            here_ = tokens_.Loc(word);
            const Directive &directive = found->second;
            if (directive.where == Where::Anywhere || (directive.where == Where::World) == builder_.InWorld()) {
                directive.read(*this);
            } else {
                builder_.WrongBlock(word.text, here_);
                SkipToNextDirective();
            }
        }
    }

  private:
    using D = DirectiveReader;
    using B = DescriptionBuilder;
    enum class Where { Anywhere, Options, World };
    struct Directive {
        Where where;
        void (*read)(D &);
    };
    static const std::unordered_map<std::string_view, Directive> &Directives() {
        using S = SceneDescription;
        using enum Where;
        static const std::unordered_map<std::string_view, Directive> directives = {
            {"Accelerator", {Options, [](D &d) { d.ReadOptionsEntity(&S::accelerator, "Accelerator"); }}},
            {"ActiveTransform", {Anywhere, [](D &d) { d.ReadActiveTransform(); }}},
            {"AreaLightSource", {World, [](D &d) { d.ReadEntity(&B::SetAreaLight); }}},
            {"Attribute", {Anywhere, [](D &d) { d.ReadAttribute(); }}},
            {"AttributeBegin", {World, [](D &d) { d.builder_.BeginAttributes(d.here_); }}},
            {"AttributeEnd", {World, [](D &d) { d.builder_.EndAttributes(d.here_); }}},
            {"Camera", {Options, [](D &d) { d.ReadEntity(&B::SetCamera); }}},
            {"ColorSpace", {Anywhere, [](D &d) { d.ReadColorSpace(); }}},
            {"ConcatTransform", {Anywhere, [](D &d) { d.builder_.Concat(d.ReadMatrix(), d.here_); }}},
            {"CoordinateSystem", {Anywhere, [](D &d) { d.builder_.DefineCoordinateSystem(d.ReadSystem().text); }}},
            {"CoordSysTransform", {Anywhere, [](D &d) { d.builder_.UseCoordinateSystem(d.ReadSystem()); }}},
            {"Film", {Options, [](D &d) { d.ReadOptionsEntity(&S::film, "Film"); }}},
            {"Identity", {Anywhere, [](D &d) { d.builder_.SetTransform(Transform()); }}},
            {"Import", {World, [](D &d) { d.ReadImport(); }}},
            {"Include", {Anywhere, [](D &d) { d.ReadInclude(); }}},
            {"Integrator", {Options, [](D &d) { d.ReadOptionsEntity(&S::integrator, "Integrator"); }}},
            {"LightSource", {World, [](D &d) { d.ReadEntity(&B::AddLight); }}},
            {"LookAt", {Anywhere, [](D &d) { d.ReadLookAt(); }}},
            {"MakeNamedMaterial", {World, [](D &d) { d.ReadNamed("A material name", &B::AddNamedMaterial); }}},
            {"MakeNamedMedium", {Anywhere, [](D &d) { d.ReadNamed("A medium name", &B::AddMedium); }}},
            {"Material", {World, [](D &d) { d.ReadEntity(&B::AddMaterial); }}},
            {"MediumInterface", {Anywhere, [](D &d) { d.ReadMediumInterface(); }}},
            {"NamedMaterial", {World, [](D &d) { d.ReadNamedMaterial(); }}},
            {"ObjectBegin", {World, [](D &d) { d.builder_.BeginObject(d.ReadName("An object name"), d.here_); }}},
            {"ObjectEnd", {World, [](D &d) { d.builder_.EndObject(d.here_); }}},
            {"ObjectInstance", {World, [](D &d) { d.builder_.AddInstance(d.ReadName("An object name"), d.here_); }}},
            {"Option", {Anywhere, [](D &d) { d.ReadOption(); }}},
            {"PixelFilter", {Options, [](D &d) { d.ReadOptionsEntity(&S::filter, "PixelFilter"); }}},
            {"ReverseOrientation", {World, [](D &d) { d.State().reverseOrientation ^= true; }}},
            {"Rotate", {Anywhere, [](D &d) { d.ReadRotate(); }}},
            {"Sampler", {Options, [](D &d) { d.ReadOptionsEntity(&S::sampler, "Sampler"); }}},
            {"Scale", {Anywhere, [](D &d) { d.ReadScale(); }}},
            {"Shape", {World, [](D &d) { d.ReadEntity(&B::AddShape); }}},
            {"Texture", {World, [](D &d) { d.ReadTexture(); }}},
            {"Transform", {Anywhere, [](D &d) { d.builder_.SetTransform(d.ReadMatrix()); }}},
            {"TransformBegin", {World, [](D &d) { d.ReadTransformBlock(&B::BeginAttributes); }}},
            {"TransformEnd", {World, [](D &d) { d.ReadTransformBlock(&B::EndAttributes); }}},
            {"TransformTimes", {Options, [](D &d) { d.ReadTransformTimes(); }}},
            {"Translate", {Anywhere, [](D &d) { d.builder_.Concat(Transform::Translate(d.ReadVector()), d.here_); }}},
            {"WorldBegin", {Options, [](D &d) { d.builder_.WorldBegin(); }}},
        };
        return directives;
    }

    /// Skips values and parameter lists up to the next word, which begins a directive.
    void SkipToNextDirective() {
        for (;;) {
            const Token &token = tokens_.Peek();
            if (token.kind == TokenKind::End) return;
            if (token.kind == TokenKind::Word && std::isalpha(static_cast<unsigned char>(token.text[0])) &&
                token.text != "true" && token.text != "false")
                return;
            tokens_.Next();
        }
    }

    void Unknown(const Token &word) {
        std::vector<std::string> words;
        for (const auto &[known, directive] : Directives()) words.emplace_back(known);
        std::sort(words.begin(), words.end());
        const std::string shown = Abbreviate(word.text);
        std::string message = fmt::format("Unknown directive: {}; {}{}.", shown, OldNameHint("directive", shown),
                                          ListChoices(shown, words));
        constexpr int kMax = 5;
        if (++unknownWords_ == kMax) arguments_.Fail(word, message + " Too many unknown directives: parsing ends.");
        Error(word, message);
        SkipToNextDirective();
    }

    GraphicsState &State() { return builder_.State(); }
    void Error(const Token &token, std::string message) {
        builder_.Sink().Error(tokens_.Loc(token), std::move(message));
    }

    std::string ReadType() { return std::string(arguments_.ReadString("a type name").text); }
    Params ReadParams() { return arguments_.ReadList(State().colorSpace); }
    /// Reads a name, which must not be empty.
    GivenName ReadName(const char *what) {
        Token token = arguments_.ReadString(what);
        if (token.text.empty()) Error(token, fmt::format("{} must not be empty.", what));
        return {arguments_.NameOf(token), tokens_.Loc(token)};
    }
    GivenName ReadSystem() { return ReadName("A coordinate system name"); }

    Vector3 ReadVector() {
        Vector3 v;
        for (int i = 0; i < 3; ++i) v[i] = arguments_.ReadFloat("a number");
        return v;
    }

    /// Index in `choices` of the word; if it is none of them, an error.
    std::optional<size_t> Choose(const Token &word, const char *what, const std::vector<std::string> &choices) {
        const auto found = std::find(choices.begin(), choices.end(), word.text);
        if (found != choices.end()) return found - choices.begin();
        Error(word, fmt::format("Unknown {} \"{}\"; {}{}.", what, Abbreviate(word.text), OldNameHint(what, word.text),
                                ListChoices(word.text, choices)));
        return {};
    }

    void ReadEntity(void (B::*add)(const std::string &type, Params params, const FileLoc &loc)) {
        const std::string type = ReadType();
        (builder_.*add)(type, ReadParams(), here_);
    }
    void ReadOptionsEntity(Entity SceneDescription::*entity, const char *directive) {
        const std::string type = ReadType();
        builder_.SetEntity(entity, directive, type, ReadParams(), here_);
    }
    void ReadNamed(const char *what, void (B::*add)(const GivenName &name, Params params, const FileLoc &loc)) {
        const GivenName name = ReadName(what);
        (builder_.*add)(name, ReadParams(), here_);
    }
    void ReadNamedMaterial() { State().material = {-1, ReadName("A material name").text}; }
    void ReadTransformBlock(void (B::*block)(const FileLoc &loc)) {
        builder_.WarnTransformBlock(here_);
        (builder_.*block)(here_);
    }

    Transform ReadMatrix() {
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

    void ReadScale() {
        Vector3 s = ReadVector();
        if (s.x == 0 || s.y == 0 || s.z == 0)
            builder_.Sink().Warning(here_, "A scale of 0 cannot be inverted: it flattens what it transforms.");
        builder_.Concat(Transform::Scale(s), here_);
    }

    void ReadRotate() {
        Float degrees = arguments_.ReadFloat("an angle in degrees");
        Vector3 axis = ReadVector();
        const Float size = MaxComponent(Abs(axis));
        if (size > 0)  // the squared length of a very long or short axis would overflow or underflow
            builder_.Concat(Transform::Rotate(degrees, axis / size), here_);
        else builder_.Sink().Error(here_, "Rotate: the axis has length zero.");
    }

    void ReadLookAt() {
        Point3 eye = ReadVector(), look = ReadVector();
        Vector3 up = ReadVector();
        if (auto view = Transform::LookAt(eye, look, up)) builder_.Concat(*view, here_);
        else
            builder_.Sink().Error(
                here_, "LookAt: the eye and the point looked at are the same, or up is parallel to the view.");
    }

    void ReadActiveTransform() {
        const Token word = arguments_.ReadWord("All, StartTime or EndTime");
        const auto choice = Choose(word, "time", {"All", "StartTime", "EndTime"});
        if (!choice) return;
        State().startActive = *choice != 2;
        State().endActive = *choice != 1;
    }

    void ReadTransformTimes() {
        State().startTime = arguments_.ReadFloat("the start time");
        State().endTime = arguments_.ReadFloat("the end time");
        if (State().endTime < State().startTime) builder_.Sink().Error(here_, "TransformTimes ends before it starts.");
    }

    void ReadOption() {
        Token token = arguments_.ReadString("an option name");
        std::string name = Lower(std::string(token.text));
        std::erase_if(name, [](char c) { return c == '-' || c == '_'; });
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
            if (!(scale > 0)) Error(token, fmt::format("\"{}\" is {}; it must be above 0.", token.text, scale));
        } else if (name == "seed") {
            options.seed = arguments_.ReadInt("a seed");
        } else if (name == "msereferenceimage" || name == "msereferenceout") {
            options.mseReferenceLoc = tokens_.Loc(token);
            (name.ends_with("out") ? options.mseReferenceOut : options.mseReferenceImage) =
                arguments_.ReadString("a file name").text;
        } else if (name == "rendercoordsys") {
            Token value = arguments_.ReadString("a coordinate system");
            if (Choose(value, "rendering coordinate system", {"camera", "cameraworld", "world"}))
                options.renderCoordSys = value.text;
        } else {
            std::vector<std::string> names = {"displacementedgescale", "msereferenceimage", "msereferenceout",
                                              "rendercoordsys", "seed"};
            for (const auto &[switchName, member] : kSwitches) names.push_back(switchName);
            Error(token, fmt::format("Unknown option \"{}\"; {}.", Abbreviate(token.text), ListChoices(name, names)));
            SkipToNextDirective();
        }
    }

    void ReadAttribute() {
        Token target = arguments_.ReadString("an attribute target");
        Params params = ReadParams();
        if (const auto index = Choose(target, "attribute target", {"shape", "light", "material", "medium", "texture"}))
            builder_.AddAttributes(static_cast<AttributeTarget>(*index), std::string(target.text), std::move(params),
                                   here_);
    }

    void ReadColorSpace() {
        Token name = arguments_.ReadString("a colour space name");
        builder_.SetColorSpace(std::string(name.text), tokens_.Loc(name));
    }

    void ReadMediumInterface() {
        GraphicsState &state = State();
        state.insideMedium = arguments_.NameOf(arguments_.ReadString("a medium name"));
        state.outsideMedium = state.insideMedium;
        if (tokens_.Peek().kind == TokenKind::String) state.outsideMedium = arguments_.NameOf(tokens_.Next());
    }

    void ReadTexture() {
        const GivenName name = ReadName("A texture name");
        Token family = arguments_.ReadString("\"float\" or \"spectrum\"");
        std::string type(arguments_.ReadString("a texture class").text);
        Params params = ReadParams();
        if (const auto kind = Choose(family, "kind of texture", {"float", "spectrum"}))
            builder_.AddTexture(name, *kind == 1, type, std::move(params), here_);
    }

    /// Reads the file that the next token names. On failure, reports an error and returns null.
    std::shared_ptr<const SourceFile> ReadFile(std::string *key) {
        Token token = arguments_.ReadString("a file name");
        FileLoc loc = tokens_.Loc(token);
        std::string name(token.text);
        std::string path = name == "-" ? name : files_.Resolve(name);
        builder_.CountFile(loc);
        if (tokens_.Depth() >= kMaxNesting)
            throw UserError(loc, "{}: files are nested more than {} deep.", Abbreviate(path), kMaxNesting);
        try {
            std::string wanted = SceneFileKey(path);
            if (tokens_.IsOpen(wanted)) throw UserError("{}: the file reads itself.", path);
            *key = wanted;
            builder_.AddSource(path);
            return OpenSceneFile(path);
        } catch (const UserError &e) {
            for (const Diagnostic &d : e.Diagnostics()) builder_.Sink().Error(loc, d.message);
            return nullptr;
        }
    }

    void ReadInclude() {
        std::string key;
        if (auto file = ReadFile(&key)) tokens_.Push(std::move(file), std::move(key));
    }

    /// Unlike stock pbrt-v4, which imports files in parallel, imports sequentially for determinism.
    void ReadImport() {
        std::string key;
        auto file = ReadFile(&key);
        if (!file) return;
        builder_.BeginImport();
        builder_.EndImport(ReadDirectives(std::move(file), std::move(key), files_, builder_, &tokens_));
    }

    Tokenizer &tokens_;
    DescriptionBuilder &builder_;
    const FileResolver &files_;
    ParameterReader arguments_;
    FileLoc here_;  ///< of the directive being read
    int unknownWords_ = 0;
};

}  // namespace

bool ReadDirectives(std::shared_ptr<const SourceFile> file, std::string key, const FileResolver &files,
                    DescriptionBuilder &builder, const Tokenizer *outer) {
    return Collect(builder.Sink(), [&] {
        Tokenizer tokens(outer);
        tokens.Push(std::move(file), std::move(key));
        DirectiveReader(tokens, builder, files).Run();
    });
}

SceneDescription ParseSceneFiles(const std::vector<std::string> &paths, DiagnosticSink &sink) {
    DescriptionBuilder builder(sink);
    FileResolver files;
    FileLoc where;
    bool complete = true;
    // After a syntax error the state is undefined, and following files would give false errors.
    for (size_t i = 0; i < paths.size() && complete; ++i) {
        const std::string &path = paths[i];
        files = path == "-" ? FileResolver() : FileResolver(std::filesystem::path(path).parent_path());
        std::shared_ptr<const SourceFile> file;
        builder.AddSource(path);
        complete = Collect(sink, [&] { file = OpenSceneFile(path, ReadFrom::FilesAndPipes); });
        if (!complete) break;
        where = {file, 0, 0};
        complete = ReadDirectives(std::move(file), SceneFileKey(path), files, builder);
    }
    return builder.Finish(complete, where, std::move(files));
}

}  // namespace pbrt
