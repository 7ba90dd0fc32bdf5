#include "pbrt/textures/texture_makers.h"

#include "pbrt/textures/checkerboard_texture.h"
#include "pbrt/textures/image_texture.h"
#include "pbrt/textures/noise_textures.h"

namespace pbrt {

namespace {

/// Texture classes are templates over FloatKind or SpectrumKind, which define parameter types and the conversion of
/// operands and values to textures.
struct FloatKind {
    using Ptr = FloatTexturePtr;
    using Operand = FloatTextureParam;
    using Value = Float;
    template <template <class, class, class...> class T>
    using Texture = FloatFamily<T>;

    static Operand DefaultOperand(Float value) { return {value}; }
    static Value DefaultValue(Float value) { return value; }
    static Ptr Make(const Operand &p, const TextureRequest &r) { return r.floatTexture(p); }
    static Ptr Make(Value value, const TextureRequest &) { return std::make_shared<ConstantFloatTexture>(value); }
};

struct SpectrumKind {
    using Ptr = SpectrumTexturePtr;
    using Operand = SpectrumTextureParam;
    using Value = SpectrumParam;
    template <template <class, class, class...> class T>
    using Texture = SpectrumFamily<T>;

    static Operand DefaultOperand(Float value) { return {DefaultValue(value)}; }
    static Value DefaultValue(Float value) { return {SpectrumUse::Unbounded, value}; }
    static Ptr Make(Operand p, const TextureRequest &r) {
        p.use = r.use;
        return r.spectrumTexture(p);
    }
    static Ptr Make(Value value, const TextureRequest &r) {
        value.use = r.use;
        return std::make_shared<ConstantSpectrumTexture>(value.Make(r.files));
    }
};

template <class Kind>
struct ConstantParams {
    typename Kind::Value value = Kind::DefaultValue(1);
    template <class V>
    void Describe(V &&v) {
        v("value", value, "value of the texture");
    }
};

FloatTexturePtr ScaleBy(const FloatTexturePtr &texture, Float factor) {
    if (factor == 1) return texture;
    if (auto constant = texture->Constant()) return std::make_shared<ConstantFloatTexture>(*constant * factor);
    if (auto image = dynamic_cast<const ImageFloatTexture *>(texture.get())) return image->Scaled(factor);
    return nullptr;
}
SpectrumTexturePtr ScaleBy(const SpectrumTexturePtr &texture, Float factor) {
    if (factor == 1) return texture;
    if (auto image = dynamic_cast<const ImageSpectrumTexture *>(texture.get())) return image->Scaled(factor);
    return nullptr;
}

template <class Kind>
struct ScaleParams {
    typename Kind::Operand tex = Kind::DefaultOperand(1);
    FloatTextureParam scale{1};
    template <class V>
    void Describe(V &&v) {
        v("tex", tex, "texture that is scaled");
        v("scale", scale, "the factor");
    }
};

/// Folds a constant factor on an image into the image's scale, before inversion and clamping, as in stock pbrt-v4.
template <class Kind>
typename Kind::Ptr MakeScale(const ScaleParams<Kind> &p, const ParamSet &, const TextureRequest &r) {
    auto texture = Kind::Make(p.tex, r);
    FloatTexturePtr scale = r.floatTexture(p.scale);
    if (auto factor = scale->Constant())
        if (auto scaled = ScaleBy(texture, *factor)) return scaled;
    if constexpr (std::is_same_v<Kind, FloatKind>)
        if (auto factor = texture->Constant())
            if (auto scaled = ScaleBy(scale, *factor)) return scaled;
    return std::make_shared<typename Kind::template Texture<ScaleTexture>>(std::move(texture), std::move(scale));
}

template <class Kind>
struct TwoParams {
    typename Kind::Operand first = Kind::DefaultOperand(0), second = Kind::DefaultOperand(1);
    template <class V>
    void Describe(V &&v) {
        v("tex1", first, "one operand");
        v("tex2", second, "the other operand");
    }
};

template <class Kind>
struct MixParams : TwoParams<Kind> {
    FloatTextureParam amount{Float(0.5)};
    template <class V>
    void Describe(V &&v) {
        TwoParams<Kind>::Describe(v);
        v("amount", amount, "share of tex2");
    }
};

template <class Kind>
typename Kind::Ptr MakeMix(const MixParams<Kind> &p, const ParamSet &, const TextureRequest &r) {
    auto first = Kind::Make(p.first, r), second = Kind::Make(p.second, r);
    FloatTexturePtr amount = r.floatTexture(p.amount);
    if (auto weight = amount->Constant()) {
        if (*weight == 0) return first;
        if (*weight == 1) return second;
    }
    return std::make_shared<typename Kind::template Texture<MixTexture>>(std::move(first), std::move(second),
                                                                         std::move(amount));
}

template <class Kind>
struct DirectionMixParams : TwoParams<Kind> {
    Vector3 direction{0, 1, 0};
    template <class V>
    void Describe(V &&v) {
        TwoParams<Kind>::Describe(v);
        v("dir", direction, Items{ParamType::Vector3},
          "direction; the share of tex1 is the absolute cosine of its angle to the normal");
    }
};

template <class Kind>
typename Kind::Ptr MakeDirectionMix(const DirectionMixParams<Kind> &p, const ParamSet &set, const TextureRequest &r) {
    auto first = Kind::Make(p.first, r), second = Kind::Make(p.second, r);
    Vector3 direction = r.renderFromTexture.Vector(p.direction);
    if (!(LengthSquared(direction) > 0)) throw set.Error("dir", "\"dir\" has no direction, because its length is 0.");
    return std::make_shared<typename Kind::template Texture<DirectionMixTexture>>(std::move(first), std::move(second),
                                                                                  direction);
}

template <class Kind>
struct BilerpParams : MappingParams {
    std::array<typename Kind::Value, 4> v{Kind::DefaultValue(0), Kind::DefaultValue(1), Kind::DefaultValue(0),
                                          Kind::DefaultValue(1)};
    template <class V>
    void Describe(V &&visit) {
        visit("v00", v[0], "value at (s, t) = (0, 0)");
        visit("v01", v[1], "value at (s, t) = (0, 1)");
        visit("v10", v[2], "value at (s, t) = (1, 0)");
        visit("v11", v[3], "value at (s, t) = (1, 1)");
        MappingParams::Describe(visit);
    }
};

template <class Kind>
typename Kind::Ptr MakeBilerp(const BilerpParams<Kind> &p, const ParamSet &set, const TextureRequest &r) {
    std::array<typename Kind::Ptr, 4> corners;
    for (size_t i = 0; i < 4; ++i) corners[i] = Kind::Make(p.v[i], r);
    return std::make_shared<typename Kind::template Texture<BilerpTexture>>(p.Make(set, r.renderFromTexture, r.sink),
                                                                            std::move(corners));
}

PointMapping MakePointMapping(const ParamSet &set, const TextureRequest &r, const char *what) {
    if (r.renderFromTexture.IsSingular())
        throw set.Error("", fmt::format("{} needs a transformation that can be inverted.", what));
    return PointMapping(r.renderFromTexture);
}

template <class Kind>
struct CheckerboardParams : MappingParams {
    int dimension = 2;
    typename Kind::Operand first = Kind::DefaultOperand(1), second = Kind::DefaultOperand(0);
    template <class V>
    void Describe(V &&v) {
        v("dimension", dimension, Range<int>{2, 3}, "squares (2) or cubes (3)");
        v("tex1", first, "texture of the cell at the origin and every other one");
        v("tex2", second, "texture of the cells between");
        if (v.When(dimension == 2)) MappingParams::Describe(v);
    }
};

template <class Kind>
typename Kind::Ptr MakeCheckerboard(const CheckerboardParams<Kind> &p, const ParamSet &set, const TextureRequest &r) {
    CheckerPattern pattern = p.dimension == 2 ? CheckerPattern(p.Make(set, r.renderFromTexture, r.sink))
                                              : CheckerPattern(MakePointMapping(set, r, "dimension 3"));
    auto first = Kind::Make(p.first, r), second = Kind::Make(p.second, r);
    return std::make_shared<typename Kind::template Texture<CheckerboardTexture>>(std::move(pattern), std::move(first),
                                                                                  std::move(second));
}

template <class Kind>
struct DotsParams : MappingParams {
    typename Kind::Operand inside = Kind::DefaultOperand(1), outside = Kind::DefaultOperand(0);
    template <class V>
    void Describe(V &&v) {
        v("inside", inside, "texture around the dots, as in stock");
        v("outside", outside, "texture in the dots, as in stock");
        MappingParams::Describe(v);
    }
};

/// As in stock pbrt-v4, "outside" is inside the dots and "inside" around them.
template <class Kind>
typename Kind::Ptr MakeDots(const DotsParams<Kind> &p, const ParamSet &set, const TextureRequest &r) {
    DotPattern pattern(p.Make(set, r.renderFromTexture, r.sink));
    auto inside = Kind::Make(p.inside, r), outside = Kind::Make(p.outside, r);
    return std::make_shared<typename Kind::template Texture<DotsTexture>>(std::move(pattern), std::move(outside),
                                                                          std::move(inside));
}

struct NoiseParams {
    NoiseOctaves octaves;
    template <class V>
    void Describe(V &&v) {
        // Each octave has nearly twice the frequency of the previous.
        v("octaves", octaves.count, Range<int>{0, 64}, "number of octaves of noise that are added");
        v("roughness", octaves.roughness, "strength of an octave relative to the one before");
    }
};

struct MarbleParams {
    NoiseParams noise;
    Float scale = 1, variation = Float(0.2);
    template <class V>
    void Describe(V &&v) {
        noise.Describe(v);
        v("scale", scale, "factor of the position in texture space");
        v("variation", variation, "how far the noise moves the veins");
    }
};

constexpr NamedValue<TextureFilter> kFilters[] = {{"point", TextureFilter::Point},
                                                  {"bilinear", TextureFilter::Bilinear},
                                                  {"trilinear", TextureFilter::Trilinear},
                                                  {"ewa", TextureFilter::Ewa},
                                                  {"EWA", TextureFilter::Ewa}};
constexpr NamedValue<WrapMode> kWraps[] = {{"repeat", WrapMode::Repeat},
                                           {"black", WrapMode::Black},
                                           {"clamp", WrapMode::Clamp},
                                           {"octahedralsphere", WrapMode::OctahedralSphere}};

struct ImagemapParams : MappingParams {
    std::string filename, encoding;
    MipMapKey key;
    Float scale = 1;
    bool invert = false;
    template <class V>
    void Describe(V &&v) {
        v("filename", filename, Required(), "the image");
        v("filter", key.filter, kFilters, "how the image is filtered");
        v("maxanisotropy", key.maxAnisotropy, Positive(1e6f),
          "of filter ewa: largest ratio of length to width of the footprint");
        v("wrap", key.wrap, kWraps, "what lies outside of the image");
        v("scale", scale, "factor of the values");
        v("invert", invert, "take 1 minus the value");
        v("encoding", encoding, "sRGB, linear or \"gamma X\"; default: what the file says");
        MappingParams::Describe(v);
    }
    MipMapKey Key(const ParamSet &set, const FileResolver &files) const {
        MipMapKey k = key;
        k.path = files.Resolve(filename);
        k.encoding = ColorEncoding::Parse(encoding);
        if (!k.encoding && !encoding.empty())
            throw set.Error("encoding", fmt::format("\"{}\" is no encoding; valid: sRGB, linear, \"gamma X\" with X "
                                                    "above 0.",
                                                    encoding));
        return k;
    }
};

ImageOverlay MakeImageOverlay(const ImagemapParams &p, const ParamSet &set, const TextureRequest &r) {
    ImageOverlay overlay;
    overlay.mapping = p.Make(set, r.renderFromTexture, r.sink);
    overlay.scale = p.scale;
    overlay.invert = p.invert;
    const MipMapKey key = p.Key(set, r.files);
    if (!FileExists(key.path))
        throw MissingImageError(fmt::format("{}: file not found.", p.filename), set.LocOf("filename"));
    overlay.image = set.At("filename", [&] { return r.images.GetMipMap(key); });
    return overlay;
}

template <class Kind, class Table>
void AddOfBothFamilies(Table &table) {
    table.template Add<ConstantParams<Kind>>(
        "constant", "",
        [](const auto &p, const ParamSet &, const TextureRequest &r) { return Kind::Make(p.value, r); });
    table.template Add<ScaleParams<Kind>>("scale", "", MakeScale<Kind>);
    table.template Add<MixParams<Kind>>("mix", "", MakeMix<Kind>);
    table.template Add<DirectionMixParams<Kind>>("directionmix", "", MakeDirectionMix<Kind>);
    table.template Add<BilerpParams<Kind>>("bilerp", "", MakeBilerp<Kind>);
    table.template Add<CheckerboardParams<Kind>>("checkerboard", "", MakeCheckerboard<Kind>);
    table.template Add<DotsParams<Kind>>("dots", "swapped, as in stock", MakeDots<Kind>);
}

template <class Texture>
FloatTexturePtr MakeNoise(const NoiseParams &p, const ParamSet &set, const TextureRequest &r) {
    return std::make_shared<Texture>(MakePointMapping(set, r, "noise"), p.octaves);
}

}  // namespace

const FloatTextureTable &FloatTextures() {
    static const FloatTextureTable table = [] {
        using Request = const TextureRequest;
        FloatTextureTable t("float texture class");
        AddOfBothFamilies<FloatKind>(t);
        t.Add<ImagemapParams>("imagemap", "`wrap \"black\"` **differs**, see below",
                              [](const auto &p, const ParamSet &set, Request &r) {
                                  return std::make_shared<ImageFloatTexture>(MakeImageOverlay(p, set, r));
                              });
        t.Add<NoiseParams>("fbm", "", MakeNoise<FbmTexture>);
        t.Add<NoiseParams>("wrinkled", "", MakeNoise<WrinkledTexture>);
        t.Add<NoParams>("windy", "", [](const auto &, const ParamSet &set, Request &r) {
            return std::make_shared<WindyTexture>(MakePointMapping(set, r, "noise"));
        });
        return t;
    }();
    return table;
}

const SpectrumTextureTable &SpectrumTextures() {
    static const SpectrumTextureTable table = [] {
        using Request = const TextureRequest;
        SpectrumTextureTable t("spectrum texture class");
        AddOfBothFamilies<SpectrumKind>(t);
        t.Add<ImagemapParams>("imagemap", "as the float texture", [](const auto &p, const ParamSet &set, Request &r) {
            return std::make_shared<ImageSpectrumTexture>(MakeImageOverlay(p, set, r), r.use);
        });
        t.Add<MarbleParams>("marble", "", [](const auto &p, const ParamSet &set, Request &r) {
            return std::make_shared<MarbleTexture>(MakePointMapping(set, r, "noise"),
                                                   MarbleSettings{p.noise.octaves, p.scale, p.variation});
        });
        return t;
    }();
    return table;
}

MipMapKey ReadMipMapKey(const ParamSet &params, const FileResolver &files) {
    DiagnosticSink ignored;
    return ReadParams<ImagemapParams>(params, ignored).Key(params, files);
}

}  // namespace pbrt
