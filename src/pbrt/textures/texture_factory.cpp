#include "pbrt/textures/texture_factory.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <vector>

#include "pbrt/core/files.h"
#include "pbrt/core/limits.h"
#include "pbrt/textures/basic_textures.h"
#include "pbrt/textures/texture_makers.h"

namespace pbrt {

const std::vector<std::string> &SupportedTextures() {
    static const std::vector<std::string> kNames = {"bilerp", "checkerboard", "constant", "directionmix", "dots", "fbm",
                                                    "imagemap", "marble", "mix", "scale", "windy", "wrinkled"};
    return kNames;
}

const std::vector<std::string> &UnsupportedTextures() {
    static const std::vector<std::string> kNames = {"ptex"};
    return kNames;
}

namespace {

bool Contains(const std::vector<std::string> &names, const std::string &name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// Classes of format §8 that only one family has.
bool FamilyHasClass(bool isSpectrum, const std::string &textureClass) {
    if (textureClass == "marble") return isSpectrum;
    if (textureClass == "fbm" || textureClass == "wrinkled" || textureClass == "windy") return !isSpectrum;
    return true;
}

constexpr const char *kWhyNoPtex =
    "no library that Debian packages reads Ptex files (its OpenImageIO is built without). Bake the texture into an image "
    "and use class \"imagemap\".";

const char *FamilyName(bool isSpectrum) { return isSpectrum ? "spectrum" : "float"; }

using ParamTypes = std::initializer_list<ParamType>;

/// The type the directive itself gives a parameter with, the last one if several; nullopt if it does not.
std::optional<ParamType> OwnType(const ParamSet &params, const std::string &name, ParamTypes types) {
    std::optional<ParamType> found;
    for (const Param &p : params.Own())
        if (p.name == name && std::find(types.begin(), types.end(), p.type) != types.end()) found = p.type;
    return found;
}

/// The texture reference in force, nullptr if the parameter is absent or a value. Whatever loses stays unused.
const Param *FindReference(const ParamSet &params, const std::string &name, ParamTypes types) {
    std::optional<ParamType> own = OwnType(params, name, types);
    if (own && *own != ParamType::Texture) return nullptr;
    const Param *p = params.Find(name, ParamType::Texture);
    if (p && p->strings.size() != 1)
        throw UserError(fmt::format("{}: \"texture {}\" takes one name, found {}.", params.What(), name,
                                    p->strings.size()),
                        p->loc);
    return p;
}

}  // namespace

namespace {

/// What a look-up of a texture costs at most: how deep it calls other textures, and how many evaluations that makes
/// (which double with every level where both operands are the same).
struct LookupCost {
    int depth = 1;
    double evaluations = 1;
    void AddOperand(const LookupCost &operand) {
        depth = std::max(depth, operand.depth + 1);
        evaluations += operand.evaluations;
    }
};
constexpr double kMaxEvaluations = 1 << 16;

template <class Ptr>
struct Made {
    Ptr texture;
    LookupCost cost;
};

}  // namespace

struct TextureLibrary::Impl {
    struct Definition {
        std::string name, textureClass;
        bool isSpectrum = false;
        bool broken = false;  ///< reported when it was defined: stands in silently
        bool made = false;
        bool failed = false;
        ParamSet params;
        Transform renderFromTexture;
        Made<FloatTexturePtr> asFloat;
        std::array<Made<SpectrumTexturePtr>, 3> asSpectrum;  ///< by SpectrumUse
    };

    FileResolver files;
    DiagnosticSink &sink;
    size_t &missingImages;
    ImageCache images;
    bool imagesPreloaded = false;
    int nesting = 0;                                       ///< of textures being made
    std::vector<std::unique_ptr<Definition>> definitions;  ///< in file order
    std::map<std::string, size_t> indexOf[2];              ///< by family: float, spectrum

    /// All names of a family that may be used at `limit`.
    std::vector<std::string> Names(bool isSpectrum, size_t limit) const {
        std::vector<std::string> names;
        for (const auto &[name, index] : indexOf[isSpectrum])
            if (index < limit) names.push_back(name);
        return names;
    }

    /// The definition a parameter refers to; only those before `limit`, and image maps.
    Definition &Resolve(const ParamSet &params, const Param &reference, bool isSpectrum, size_t limit) {
        const std::string &name = reference.strings[0];
        auto found = indexOf[isSpectrum].find(name);
        if (found != indexOf[isSpectrum].end()) {
            Definition &d = *definitions[found->second];
            if (found->second < limit || d.textureClass == "imagemap") return d;
        }
        std::string problem = fmt::format("{}: \"{}\": there is no {} texture \"{}\"", params.What(), reference.name,
                                          FamilyName(isSpectrum), Abbreviate(name));
        if (found != indexOf[isSpectrum].end())
            problem += " yet (a texture must be defined before another one uses it)";
        else if (indexOf[!isSpectrum].contains(name))
            problem += fmt::format(" (\"{}\" is a {} texture)", name, FamilyName(!isSpectrum));
        // The list takes time, which an error that is only counted is not worth.
        std::vector<std::string> names = sink.IsFull() ? std::vector<std::string>() : Names(isSpectrum, limit);
        problem += names.empty() ? fmt::format("; no {} texture is defined.", FamilyName(isSpectrum))
                                 : "; " + ListChoices(name, names) + ".";
        throw UserError(problem, reference.loc);
    }

    /// `user`: of the texture that the parameter belongs to; null for materials and shapes.
    FloatTexturePtr FindFloat(const ParamSet &params, const std::string &name, std::optional<Float> defaultValue,
                              size_t limit, LookupCost *user = nullptr) {
        if (const Param *p = FindReference(params, name, {ParamType::Float, ParamType::Texture}))
            return Use(MakeFloat(Resolve(params, *p, false, limit), p->loc), user, *p);
        const Param *p = params.Find(name, ParamType::Float);
        if (!p && !defaultValue) return nullptr;
        return std::make_shared<ConstantFloatTexture>(params.GetFloat(name, defaultValue.value_or(0)));
    }

    SpectrumTexturePtr FindSpectrum(const ParamSet &params, const std::string &name, SpectrumPtr defaultValue,
                                    SpectrumUse use, size_t limit, LookupCost *user = nullptr) {
        const ParamTypes types = {ParamType::Rgb, ParamType::Blackbody, ParamType::Spectrum, ParamType::Texture};
        if (const Param *p = FindReference(params, name, types))
            return Use(MakeSpectrum(Resolve(params, *p, true, limit), use, p->loc), user, *p);
        SpectrumPtr value = pbrt::GetSpectrum(params, name, std::move(defaultValue), use, files);
        return value ? std::make_shared<ConstantSpectrumTexture>(std::move(value)) : nullptr;
    }

    /// The texture as an operand. Throws UserError if a look-up of its user would call too many textures.
    template <class Ptr>
    static Ptr Use(const Made<Ptr> &made, LookupCost *user, const Param &reference) {
        if (!user) return made.texture;
        user->AddOperand(made.cost);
        if (user->depth > kMaxNesting)
            throw UserError(
                fmt::format("\"texture {}\": textures are nested more than {} deep here.", reference.name, kMaxNesting),
                reference.loc);
        if (user->evaluations > kMaxEvaluations)
            throw UserError(
                fmt::format("\"texture {}\": with this operand one look-up evaluates {:.2g} textures; at most {} are "
                            "allowed. The number doubles with every texture whose two operands use the same ones.",
                            reference.name, user->evaluations, kMaxEvaluations),
                reference.loc);
        return made.texture;
    }

    TextureRequest Request(Definition &d, SpectrumUse use, LookupCost *cost) {
        size_t limit = indexOf[d.isSpectrum].at(d.name);
        return {d.textureClass,
                d.params,
                d.renderFromTexture,
                files,
                images,
                sink,
                [=, this, &d](const std::string &name, Float value) {
                    return FindFloat(d.params, name, value, limit, cost);
                },
                [=, this, &d](const std::string &name, SpectrumPtr value) {
                    return FindSpectrum(d.params, name, std::move(value), use, limit, cost);
                }};
    }

    /// Mistakes are left for the time when the texture is made.
    void PreloadImages() {
        imagesPreloaded = true;
        std::vector<MipMapKey> keys;
        for (const auto &d : definitions) {
            if (d->broken || d->textureClass != "imagemap") continue;
            try {
                MipMapKey key = ReadMipMapKey(d->params, files);
                if (FileExists(key.path)) keys.push_back(std::move(key));
            } catch (const UserError &) {
            }
        }
        images.Preload(keys);
    }

    /// Runs `make`; a mistake is reported once and nullptr returned. `user`: where the texture is used.
    template <class Make>
    auto Try(Definition &d, const FileLoc &user, Make &&make) -> decltype(make()) {
        // Operands are made first, so making nests as deep as looking up; here before the stack is used up.
        if (nesting >= kMaxNesting)
            throw UserError(fmt::format("texture \"{}\": textures are nested more than {} deep here.",
                                        Abbreviate(d.name), kMaxNesting),
                            user);
        struct Level {
            int &depth;
            explicit Level(int &n) : depth(++n) {}
            ~Level() { --depth; }
        } level(nesting);
        d.made = true;
        if (d.textureClass == "imagemap" && !imagesPreloaded) PreloadImages();
        try {
            return make();
        } catch (const MissingImageError &e) {
            if (!d.failed) ++missingImages;
            Report(d, e);
        } catch (const UserError &e) {
            Report(d, e);
        }
        return nullptr;
    }

    void Report(Definition &d, const UserError &e) {
        if (!d.failed) sink.Add(e);
        d.failed = true;
    }

    const Made<FloatTexturePtr> &MakeFloat(Definition &d, const FileLoc &user = {}) {
        Made<FloatTexturePtr> &made = d.asFloat;
        if (!made.texture && !d.broken)
            made.texture =
                Try(d, user, [&] { return MakeFloatTexture(Request(d, SpectrumUse::Unbounded, &made.cost)); });
        if (!made.texture) made = {std::make_shared<ConstantFloatTexture>(Float(0.5)), {}};
        return made;
    }

    const Made<SpectrumTexturePtr> &MakeSpectrum(Definition &d, SpectrumUse use, const FileLoc &user = {}) {
        Made<SpectrumTexturePtr> &made = d.asSpectrum[static_cast<size_t>(use)];
        if (!made.texture && !d.broken)
            made.texture = Try(d, user, [&] { return MakeSpectrumTexture(Request(d, use, &made.cost), use); });
        if (!made.texture)
            made = {std::make_shared<ConstantSpectrumTexture>(std::make_shared<ConstantSpectrum>(Float(0.5))), {}};
        return made;
    }
};

TextureLibrary::TextureLibrary(const FileResolver &files, DiagnosticSink &sink, int cacheMegabytes)
    : impl_(new Impl{files, sink, missingImages_, ImageCache(cacheMegabytes), false, 0, {}, {}}) {}

TextureLibrary::~TextureLibrary() = default;

void TextureLibrary::Define(const std::string &name, bool isSpectrum, const std::string &textureClass, ParamSet params,
                            const Transform &renderFromTexture) {
    FileLoc loc = params.Loc();
    if (impl_->indexOf[isSpectrum].contains(name))
        throw UserError(fmt::format("{} texture \"{}\" is defined twice.", FamilyName(isSpectrum), name), loc);
    auto d = std::make_unique<Impl::Definition>();
    d->name = name;
    d->textureClass = textureClass;
    d->isSpectrum = isSpectrum;
    d->params = std::move(params);
    d->renderFromTexture = renderFromTexture;
    bool known = FamilyHasClass(isSpectrum, textureClass);
    bool supported = known && Contains(SupportedTextures(), textureClass);
    bool unsupported = known && !supported && Contains(UnsupportedTextures(), textureClass);
    d->broken = !supported;
    impl_->indexOf[isSpectrum][name] = impl_->definitions.size();
    impl_->definitions.push_back(std::move(d));
    if (unsupported)
        throw UserError(fmt::format("texture \"{}\": class \"{}\" is not supported: {}", name, textureClass, kWhyNoPtex),
                        loc);
    if (!supported) {
        std::vector<std::string> choices;
        for (const auto *names : {&SupportedTextures(), &UnsupportedTextures()})
            for (const std::string &c : *names)
                if (FamilyHasClass(isSpectrum, c)) choices.push_back(c);
        throw UserError(fmt::format("texture \"{}\": there is no {} texture class \"{}\"; {}.", name,
                                    FamilyName(isSpectrum), textureClass, ListChoices(textureClass, choices)),
                        loc);
    }
}

void TextureLibrary::CheckAll() {
    for (const auto &d : impl_->definitions) {
        if (d->broken) continue;
        if (!d->made) {
            if (d->isSpectrum) impl_->MakeSpectrum(*d, SpectrumUse::Unbounded);
            else impl_->MakeFloat(*d);
        }
        if (!d->failed) d->params.ReportUnused(impl_->sink);
    }
    if (missingImages_ > 0)
        impl_->sink.Error({}, fmt::format("{} missing texture{}.", missingImages_, missingImages_ == 1 ? "" : "s"));
}

FloatTexturePtr TextureLibrary::GetFloat(const ParamSet &params, const std::string &name, Float defaultValue) {
    return GiveOut(impl_->FindFloat(params, name, defaultValue, impl_->definitions.size()));
}

FloatTexturePtr TextureLibrary::GetFloatOrNull(const ParamSet &params, const std::string &name) {
    return GiveOut(impl_->FindFloat(params, name, std::nullopt, impl_->definitions.size()));
}

SpectrumTexturePtr TextureLibrary::GetSpectrum(const ParamSet &params, const std::string &name,
                                               SpectrumPtr defaultValue, SpectrumUse use) {
    return GiveOut(impl_->FindSpectrum(params, name, std::move(defaultValue), use, impl_->definitions.size()));
}

SpectrumTexturePtr TextureLibrary::GetSpectrumOrNull(const ParamSet &params, const std::string &name, SpectrumUse use) {
    return GiveOut(impl_->FindSpectrum(params, name, nullptr, use, impl_->definitions.size()));
}

std::shared_ptr<const Image> TextureLibrary::GetLinearRgbImage(const ParamSet &params, const std::string &name) {
    std::string file = params.GetString(name, "");
    if (file.empty()) return nullptr;
    std::string path = impl_->files.Resolve(file);
    if (!FileExists(path)) throw UserError(fmt::format("{}: file not found.", file), params.LocOf(name));
    try {
        return impl_->images.GetLinearRgb(path);
    } catch (const UserError &e) {
        throw UserError(e.Diagnostics().front().message, params.LocOf(name));
    }
}

}  // namespace pbrt
