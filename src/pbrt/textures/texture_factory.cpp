#include "pbrt/textures/texture_factory.h"

#include <algorithm>
#include <array>

#include "pbrt/textures/texture_makers.h"

namespace pbrt {
namespace {

/// Parameter that names a texture; nullptr if a value (one of `types`) applies or nothing is given.
const Param *TakeReference(ParamReader &reader, const std::string &name, std::initializer_list<ParamType> types) {
    const Param *applicable = reader.Set().FindIf(name, [&](ParamType type) {
        return type == ParamType::Texture || std::find(types.begin(), types.end(), type) != types.end();
    });
    if (applicable && applicable->type != ParamType::Texture) return nullptr;
    reader.Declare(name, ParamType::Texture);
    if (applicable) detail::RequireCount(reader.Set(), *applicable, applicable->strings.size(), 1);
    return applicable;
}

constexpr const char *kWhyNoPtex =
    "no library of Debian reads Ptex files (its OpenImageIO is built without Ptex support). Bake the texture into an "
    "image and use class \"imagemap\".";

const char *FamilyName(bool isSpectrum) { return isSpectrum ? "spectrum" : "float"; }

/// Maximum cost of a lookup: nesting depth, and number of texture evaluations (doubled per level by equal operands).
struct LookupCost {
    int depth = 1;
    double evaluations = 1;
};
constexpr double kMaxEvaluations = 1 << 16;

template <class Ptr>
struct Made {
    Ptr texture;
    LookupCost cost;
};

}  // namespace

void ReadParam(ParamReader &reader, const std::string &name, FloatTextureParam &value) {
    value.set = &reader.Set();
    value.given = TakeReference(reader, name, {ParamType::Float});
    if (value.given) return;
    value.given = reader.Take(name, ParamType::Float);
    if (value.given) detail::RequireCount(*value.set, *value.given, value.given->floats.size(), 1);
}

void ReadParam(ParamReader &reader, const std::string &name, FloatTextureParam &value, const Range<Float> &range) {
    ReadParam(reader, name, value);
    value.range = range;
}

void ReadParam(ParamReader &reader, const std::string &name, SpectrumTextureParam &value) {
    value.set = &reader.Set();
    value.given = TakeReference(reader, name, {ParamType::Rgb, ParamType::Blackbody, ParamType::Spectrum});
    if (!value.given) ReadParam(reader, name, static_cast<SpectrumParam &>(value));
}

void DocumentParam(ParamDoc &doc, const FloatTextureParam &value) {
    doc.types = {ParamType::Float, ParamType::Texture};
    if (value.constant) doc.defaultValue = fmt::format("{}", *value.constant);
}

void DocumentParam(ParamDoc &doc, const SpectrumTextureParam &value) {
    DocumentParam(doc, static_cast<const SpectrumParam &>(value));
    doc.types.push_back(ParamType::Texture);
}

struct TextureLibrary::Impl {
    struct Definition {
        std::string name, textureClass;
        bool isSpectrum = false;
        bool broken = false;  ///< reported once; replaced by a constant silently
        bool made = false;
        bool failed = false;
        ParamSet params;
        Transform renderFromTexture;
        Made<FloatTexturePtr> asFloat;
        std::array<Made<SpectrumTexturePtr>, 3> asSpectrum;  ///< by SpectrumUse
    };

    FileResolver files;
    DiagnosticSink &sink;
    ImageCache images;
    size_t missingImages = 0;  ///< image textures with missing files, already reported
    bool imagesPreloaded = false;
    int nesting = 0;                                       ///< current depth of nested creation
    std::vector<std::unique_ptr<Definition>> definitions;  ///< in file order
    std::map<std::string, size_t> indexOf[2];              ///< by family: float, spectrum

    /// Definition that a parameter refers to: one before `limit`, or any image map. Throws UserError if there is none.
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
        // Skipped if the error is only counted, because the list takes time.
        std::vector<std::string> names;
        for (const auto &[usable, index] : indexOf[isSpectrum])
            if (index < limit && !sink.IsFull()) names.push_back(usable);
        problem += names.empty() ? fmt::format("; no {} texture is defined.", FamilyName(isSpectrum))
                                 : "; " + ListChoices(name, names) + ".";
        throw UserError(problem, reference.loc);
    }

    /// `user`: cost of the texture that owns the parameter; null for materials and shapes.
    FloatTexturePtr Find(const FloatTextureParam &p, size_t limit, LookupCost *user = nullptr) {
        FloatTexturePtr texture;
        if (p.given && p.given->type == ParamType::Texture)
            texture = Use(MakeFloat(Resolve(*p.set, *p.given, false, limit), p.given->loc), user, *p.given);
        else if (p.given || p.constant)
            texture = std::make_shared<ConstantFloatTexture>(p.given ? p.given->floats[0] : *p.constant);
        if (p.given && p.range)
            if (auto constant = texture->Constant()) p.set->Require<Float>(p.given->name, *constant, *p.range);
        return texture;
    }

    SpectrumTexturePtr Find(const SpectrumTextureParam &p, size_t limit, LookupCost *user = nullptr) {
        if (p.given && p.given->type == ParamType::Texture)
            return Use(MakeSpectrum(Resolve(*p.set, *p.given, true, limit), p.use, p.given->loc), user, *p.given);
        SpectrumPtr value = p.Make(files);
        return value ? std::make_shared<ConstantSpectrumTexture>(std::move(value)) : nullptr;
    }

    /// The texture as an operand. Throws UserError if its user's lookup would become too expensive.
    template <class Ptr>
    static Ptr Use(const Made<Ptr> &made, LookupCost *user, const Param &reference) {
        if (!user) return made.texture;
        user->depth = std::max(user->depth, made.cost.depth + 1);
        user->evaluations += made.cost.evaluations;
        if (user->depth > kMaxNesting)
            throw UserError(reference.loc, "\"texture {}\": textures are nested more than {} deep here.",
                            reference.name, kMaxNesting);
        if (user->evaluations > kMaxEvaluations)
            throw UserError(reference.loc,
                            "\"texture {}\": with this operand one look-up evaluates {:.2g} textures; at most {} are "
                            "allowed. The number doubles with every texture whose two operands use the same ones.",
                            reference.name, user->evaluations, kMaxEvaluations);
        return made.texture;
    }

    /// Creates the texture from a table. Parameters may be read again; warnings and unused ones are reported once.
    auto MakeOf(const auto &table, Definition &d, SpectrumUse use, LookupCost *cost) {
        DiagnosticSink ignored;
        const size_t limit = indexOf[d.isSpectrum].at(d.name);
        const size_t floatLimit = d.isSpectrum ? definitions.size() : limit;  // all float ones come first, as in stock
        const TextureRequest request{d.renderFromTexture,
                                     use,
                                     files,
                                     images,
                                     d.made ? ignored : sink,
                                     [=, this](const FloatTextureParam &p) { return Find(p, floatLimit, cost); },
                                     [=, this](const SpectrumTextureParam &p) { return Find(p, limit, cost); }};
        d.made = true;
        return table.Make(d.textureClass, d.params, request);
    }

    /// Reads the files of all image maps in parallel. Errors are reported when a texture is created.
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

    /// Runs `make`; returns nullptr after an error, which is reported once. `user`: location of the use.
    auto Try(Definition &d, const FileLoc &user, auto &&make) -> decltype(make()) {
        // Operands are created first, so creation nests as deep as lookups; tested here before the stack overflows.
        if (nesting >= kMaxNesting)
            throw UserError(user, "texture \"{}\": textures are nested more than {} deep here.", Abbreviate(d.name),
                            kMaxNesting);
        struct Level {
            int &depth;
            explicit Level(int &n) : depth(++n) {}
            ~Level() { --depth; }
        } level(nesting);
        if (d.textureClass == "imagemap" && !imagesPreloaded) PreloadImages();
        try {
            return make();
        } catch (const UserError &e) {
            if (!d.failed) {
                if (dynamic_cast<const MissingImageError *>(&e)) ++missingImages;
                sink.Add(e);
            }
            d.failed = true;
        }
        return nullptr;
    }

    const Made<FloatTexturePtr> &MakeFloat(Definition &d, const FileLoc &user = {}) {
        Made<FloatTexturePtr> &made = d.asFloat;
        if (!made.texture && !d.broken)
            made.texture = Try(d, user, [&] { return MakeOf(FloatTextures(), d, SpectrumUse::Unbounded, &made.cost); });
        if (!made.texture) made = {std::make_shared<ConstantFloatTexture>(Float(0.5)), {}};
        return made;
    }

    const Made<SpectrumTexturePtr> &MakeSpectrum(Definition &d, SpectrumUse use, const FileLoc &user = {}) {
        Made<SpectrumTexturePtr> &made = d.asSpectrum[size_t(use)];
        if (!made.texture && !d.broken)
            made.texture = Try(d, user, [&] { return MakeOf(SpectrumTextures(), d, use, &made.cost); });
        if (!made.texture)
            made = {std::make_shared<ConstantSpectrumTexture>(std::make_shared<ConstantSpectrum>(Float(0.5))), {}};
        return made;
    }
};

TextureLibrary::TextureLibrary(const FileResolver &files, DiagnosticSink &sink, int cacheMegabytes)
    : impl_(new Impl{files, sink, ImageCache(cacheMegabytes), 0, false, 0, {}, {}}) {}

TextureLibrary::~TextureLibrary() = default;

void TextureLibrary::Define(const std::string &name, bool isSpectrum, const std::string &textureClass, ParamSet params,
                            const Transform &renderFromTexture) {
    FileLoc loc = params.Loc();
    if (impl_->indexOf[isSpectrum].contains(name))
        throw UserError(loc, "{} texture \"{}\" is defined twice.", FamilyName(isSpectrum), name);
    auto d = std::make_unique<Impl::Definition>();
    d->name = name;
    d->textureClass = textureClass;
    d->isSpectrum = isSpectrum;
    d->params = std::move(params);
    d->renderFromTexture = renderFromTexture;
    const bool isKnown = isSpectrum ? SpectrumTextures().Has(textureClass) : FloatTextures().Has(textureClass);
    d->broken = !isKnown;
    impl_->indexOf[isSpectrum][name] = impl_->definitions.size();
    impl_->definitions.push_back(std::move(d));
    if (isKnown) return;
    const std::string what = fmt::format("texture \"{}\"", Abbreviate(name));
    if (textureClass == kUnsupportedTexture)
        throw UserError(loc, "{}: class \"{}\" is not supported: {}", what, textureClass, kWhyNoPtex);
    std::vector<std::string> classes = isSpectrum ? SpectrumTextures().Names() : FloatTextures().Names();
    classes.push_back(kUnsupportedTexture);
    ThrowUnknown(fmt::format("{}: {} texture class", what, FamilyName(isSpectrum)), textureClass, classes, loc);
}

void TextureLibrary::CheckAll() {
    for (const auto &d : impl_->definitions) {
        if (d->broken || d->made) continue;
        if (d->isSpectrum) impl_->MakeSpectrum(*d, SpectrumUse::Unbounded);
        else impl_->MakeFloat(*d);
    }
    if (const size_t missing = impl_->missingImages; missing > 0)
        impl_->sink.Error({}, "{}.", CountText(missing, "missing texture"));
}

FloatTexturePtr TextureLibrary::Get(const FloatTextureParam &p) { return impl_->Find(p, impl_->definitions.size()); }
SpectrumTexturePtr TextureLibrary::Get(const SpectrumTextureParam &p) {
    return impl_->Find(p, impl_->definitions.size());
}

std::shared_ptr<const Image> TextureLibrary::GetLinearRgbImage(const std::string &file) {
    const std::string path = impl_->files.Resolve(file);
    if (!FileExists(path)) throw UserError("{}: file not found.", file);
    return impl_->images.GetLinearRgb(path);
}

}  // namespace pbrt
