#include "pbrt/textures/texture_makers.h"

#include "pbrt/textures/noise.h"

namespace pbrt {
namespace {

/// Makers are templates over FloatKind or SpectrumKind, which define parameter types and conversions to textures.
struct FloatKind {
    using Ptr = FloatTexturePtr;
    using Operand = FloatTextureParam;
    using Value = Float;
    using Result = Float;

    static Operand DefaultOperand(Float value) { return {value}; }
    static Value DefaultValue(Float value) { return value; }
    static Ptr Make(const Operand &p, const TextureRequest &r) { return r.floatTexture(p); }
    static Ptr Make(Value value, const TextureRequest &) { return std::make_shared<ConstantFloatTexture>(value); }
    template <class F>
    static Ptr Compute(bool usesFootprint, F f) {
        return std::make_shared<FunctionTexture<F, FloatTexture, Float>>(usesFootprint, std::move(f));
    }
};

struct SpectrumKind {
    using Ptr = SpectrumTexturePtr;
    using Operand = SpectrumTextureParam;
    using Value = SpectrumParam;
    using Result = SampledSpectrum;

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
    template <class F>
    static Ptr Compute(bool usesFootprint, F f) {
        return std::make_shared<FunctionTexture<F, SpectrumTexture, SampledSpectrum, SampledWavelengths>>(usesFootprint,
                                                                                                          std::move(f));
    }
};

/// (1 - w) first + w second, with w = weight(context); evaluates only textures of non-zero weight.
template <class Kind, class Weight>
typename Kind::Ptr Blend(const typename Kind::Ptr &first, const typename Kind::Ptr &second, bool weightUsesFootprint,
                         Weight weight) {
    const bool usesFootprint = weightUsesFootprint || first->UsesFootprint() || second->UsesFootprint();
    return Kind::Compute(usesFootprint, [=](const TextureContext &ctx, const auto &...lambda) {
        const Float w = weight(ctx);
        if (w == 0) return first->Evaluate(ctx, lambda...);
        if (w == 1) return second->Evaluate(ctx, lambda...);
        return first->Evaluate(ctx, lambda...) * (1 - w) + second->Evaluate(ctx, lambda...) * w;
    });
}

template <class Kind>
struct ConstantParams {
    typename Kind::Value value = Kind::DefaultValue(1);
    void Describe(auto &&v) { v("value", value, "value"); }
};

/// Copy of an image texture with its scale, before the inversion, multiplied by `factor`; null for other textures.
template <class Image, class Ptr>
Ptr ScaleImage(const Ptr &texture, Float factor) {
    const auto *image = dynamic_cast<const Image *>(texture.get());
    if (!image) return nullptr;
    auto scaled = std::make_shared<Image>(*image);
    scaled->overlay.scale *= factor;
    return scaled;
}

FloatTexturePtr ScaleBy(const FloatTexturePtr &texture, Float factor) {
    if (factor == 1) return texture;
    if (auto constant = texture->Constant()) return std::make_shared<ConstantFloatTexture>(*constant * factor);
    return ScaleImage<ImageFloatTexture>(texture, factor);
}
SpectrumTexturePtr ScaleBy(const SpectrumTexturePtr &texture, Float factor) {
    return factor == 1 ? texture : ScaleImage<ImageSpectrumTexture>(texture, factor);
}

template <class Kind>
struct ScaleParams {
    typename Kind::Operand tex = Kind::DefaultOperand(1);
    FloatTextureParam scale{1};
    void Describe(auto &&v) {
        v("tex", tex, "scaled texture");
        v("scale", scale, "factor");
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
    const bool usesFootprint = texture->UsesFootprint() || scale->UsesFootprint();
    return Kind::Compute(usesFootprint, [=](const TextureContext &ctx, const auto &...lambda) {
        const Float s = scale->Evaluate(ctx);
        if (s == 0) return typename Kind::Result(Float(0));
        return texture->Evaluate(ctx, lambda...) * s;
    });
}

template <class Kind>
struct TwoParams {
    typename Kind::Operand first = Kind::DefaultOperand(0), second = Kind::DefaultOperand(1);
    void Describe(auto &&v) {
        v("tex1", first, "first operand");
        v("tex2", second, "second operand");
    }
};

template <class Kind>
struct MixParams : TwoParams<Kind> {
    FloatTextureParam amount{Float(0.5)};
    void Describe(auto &&v) {
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
    return Blend<Kind>(first, second, amount->UsesFootprint(),
                       [amount](const TextureContext &ctx) { return amount->Evaluate(ctx); });
}

template <class Kind>
struct DirectionMixParams : TwoParams<Kind> {
    Vector3 direction{0, 1, 0};
    void Describe(auto &&v) {
        TwoParams<Kind>::Describe(v);
        v("dir", direction, Items{ParamType::Vector3}, "share of tex1: absolute cosine to the normal");
    }
};

template <class Kind>
typename Kind::Ptr MakeDirectionMix(const DirectionMixParams<Kind> &p, const ParamSet &set, const TextureRequest &r) {
    auto first = Kind::Make(p.first, r), second = Kind::Make(p.second, r);
    Vector3 direction = r.renderFromTexture.Vector(p.direction);
    if (!(LengthSquared(direction) > 0)) throw set.Error("dir", "\"dir\" has no direction, because its length is 0.");
    direction = Normalize(direction);
    return Blend<Kind>(second, first, false,
                       [direction](const TextureContext &ctx) { return AbsDot(ctx.n, direction); });
}

template <class Kind>
struct BilerpParams : MappingParams {
    std::array<typename Kind::Value, 4> v{Kind::DefaultValue(0), Kind::DefaultValue(1), Kind::DefaultValue(0),
                                          Kind::DefaultValue(1)};
    void Describe(auto &&visit) {
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
    const TextureMapping2D mapping = p.Make(set, r.renderFromTexture, r.sink);
    return Kind::Compute(false, [=](const TextureContext &ctx, const auto &...lambda) {
        const Point2 st = Map(mapping, ctx).st;
        const Float ws[2] = {1 - st.x, st.x}, wt[2] = {1 - st.y, st.y};
        typename Kind::Result sum(Float(0));
        for (size_t i = 0; i < 4; ++i) sum += corners[i]->Evaluate(ctx, lambda...) * (ws[i >> 1] * wt[i & 1]);
        return sum;
    });
}

PointMapping MakePointMapping(const ParamSet &set, const TextureRequest &r, const char *what) {
    if (r.renderFromTexture.IsSingular()) throw set.Error("", "{} needs a transformation that can be inverted.", what);
    return PointMapping(r.renderFromTexture);
}

template <class Kind>
struct CheckerboardParams : MappingParams {
    int dimension = 2;
    typename Kind::Operand first = Kind::DefaultOperand(1), second = Kind::DefaultOperand(0);
    void Describe(auto &&v) {
        v("dimension", dimension, Range<int>{2, 3}, "squares (2) or cubes (3)");
        v("tex1", first, "cell at the origin and every other one");
        v("tex2", second, "cells between");
        if (v.When(dimension == 2)) MappingParams::Describe(v);
    }
};

template <class Kind>
typename Kind::Ptr MakeCheckerboard(const CheckerboardParams<Kind> &p, const ParamSet &set, const TextureRequest &r) {
    const auto checkers = [&](const auto &mapping) {
        auto first = Kind::Make(p.first, r), second = Kind::Make(p.second, r);
        return Blend<Kind>(first, second, true,
                           [mapping](const TextureContext &ctx) { return CheckerWeight(mapping, ctx); });
    };
    if (p.dimension == 3) return checkers(MakePointMapping(set, r, "dimension 3"));
    return checkers(p.Make(set, r.renderFromTexture, r.sink));
}

template <class Kind>
struct DotsParams : MappingParams {
    typename Kind::Operand inside = Kind::DefaultOperand(1), outside = Kind::DefaultOperand(0);
    void Describe(auto &&v) {
        v("inside", inside, "around the dots, as in stock");
        v("outside", outside, "in the dots, as in stock");
        MappingParams::Describe(v);
    }
};

/// As in stock pbrt-v4, "outside" is inside the dots and "inside" around them.
template <class Kind>
typename Kind::Ptr MakeDots(const DotsParams<Kind> &p, const ParamSet &set, const TextureRequest &r) {
    const TextureMapping2D mapping = p.Make(set, r.renderFromTexture, r.sink);
    auto inside = Kind::Make(p.inside, r), outside = Kind::Make(p.outside, r);
    return Blend<Kind>(inside, outside, false,
                       [mapping](const TextureContext &ctx) -> Float { return IsInDot(Map(mapping, ctx).st) ? 1 : 0; });
}

struct NoiseParams {
    NoiseOctaves octaves;
    void Describe(auto &&v) {
        // Each octave has nearly twice the frequency of the previous.
        v("octaves", octaves.count, Range<int>{0, 64}, "number of noise octaves");
        v("roughness", octaves.roughness, "strength relative to the previous octave");
    }
};

struct MarbleParams {
    NoiseParams noise;
    Float scale = 1, variation = Float(0.2);
    void Describe(auto &&v) {
        noise.Describe(v);
        v("scale", scale, "factor of positions in texture space");
        v("variation", variation, "distortion of the veins");
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
    void Describe(auto &&v) {
        v("filename", filename, Required(), "image file");
        v("filter", key.filter, kFilters, "filter");
        v("maxanisotropy", key.maxAnisotropy, Positive(1e6f), "ewa: maximum length over width of the footprint");
        v("wrap", key.wrap, kWraps, "outside of the image");
        v("scale", scale, "factor of the values");
        v("invert", invert, "use 1 minus the value");
        v("encoding", encoding, "sRGB, linear or \"gamma X\"; default: the file's");
        MappingParams::Describe(v);
    }
    MipMapKey Key(const ParamSet &set, const FileResolver &files) const {
        MipMapKey k = key;
        k.path = files.Resolve(filename);
        k.encoding = ColorEncoding::Parse(encoding);
        if (!k.encoding && !encoding.empty())
            throw set.Error("encoding", "\"{}\" is no encoding; valid: sRGB, linear, \"gamma X\" with X above 0.",
                            encoding);
        return k;
    }
};

ImageOverlay MakeImageOverlay(const ImagemapParams &p, const ParamSet &set, const TextureRequest &r) {
    const TextureMapping2D mapping = p.Make(set, r.renderFromTexture, r.sink);
    const MipMapKey key = p.Key(set, r.files);
    if (!FileExists(key.path))
        throw MissingImageError(fmt::format("{}: file not found.", p.filename), set.LocOf("filename"));
    return {set.At("filename", [&] { return r.images.GetMipMap(key); }), mapping, p.scale, p.invert};
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

/// `Sum`: Signed or Creased of NoiseOctaves, evaluated in texture space.
template <auto Sum>
FloatTexturePtr MakeNoise(const NoiseParams &p, const ParamSet &set, const TextureRequest &r) {
    const PointMapping mapping = MakePointMapping(set, r, "noise");
    return FloatKind::Compute(true, [mapping, octaves = p.octaves](const TextureContext &ctx) {
        const TexCoord3 c = mapping.Map(ctx);
        return (octaves.*Sum)(c.p, c.dpdx, c.dpdy);
    });
}

}  // namespace

const FloatTextureTable &FloatTextures() {
    static const FloatTextureTable table("float texture class", [](FloatTextureTable &t) {
        AddOfBothFamilies<FloatKind>(t);
        t.Add<ImagemapParams>("imagemap", "`wrap \"black\"` **differs**: [departures](#departures)",
                              [](const auto &p, const ParamSet &set, auto &r) {
                                  return std::make_shared<ImageFloatTexture>(MakeImageOverlay(p, set, r));
                              });
        t.Add<NoiseParams>("fbm", "", MakeNoise<&NoiseOctaves::Signed>);
        t.Add<NoiseParams>("wrinkled", "", MakeNoise<&NoiseOctaves::Creased>);
        t.Add<NoParams>("windy", "", [](const auto &, const ParamSet &set, auto &r) {
            return FloatKind::Compute(true, [mapping = MakePointMapping(set, r, "noise")](const TextureContext &ctx) {
                return WindyNoise(mapping.Map(ctx));
            });
        });
    });
    return table;
}

const SpectrumTextureTable &SpectrumTextures() {
    static const SpectrumTextureTable table("spectrum texture class", [](SpectrumTextureTable &t) {
        AddOfBothFamilies<SpectrumKind>(t);
        t.Add<ImagemapParams>("imagemap", "as the float texture", [](const auto &p, const ParamSet &set, auto &r) {
            return std::make_shared<ImageSpectrumTexture>(MakeImageOverlay(p, set, r), r.use);
        });
        // Veins alternating along y of texture space. Always uplifted as a reflectance, regardless of its use.
        t.Add<MarbleParams>("marble", "", [](const auto &p, const ParamSet &set, auto &r) {
            const PointMapping mapping = MakePointMapping(set, r, "noise");
            return SpectrumKind::Compute(true, [=](const TextureContext &ctx, const SampledWavelengths &lambda) {
                const TexCoord3 c = mapping.Map(ctx);
                const Float s = p.scale;
                const Point3 q = s * c.p;
                const Float phase = q.y + p.variation * p.noise.octaves.Signed(q, s * c.dpdx, s * c.dpdy);
                return RgbAlbedoSpectrum(ColorSpace::SRGB(), MarbleColor((1 + std::sin(phase)) / 2)).Sample(lambda);
            });
        });
    });
    return table;
}

MipMapKey ReadMipMapKey(const ParamSet &params, const FileResolver &files) {
    DiagnosticSink ignored;
    return ReadParams<ImagemapParams>(params, ignored).Key(params, files);
}

}  // namespace pbrt
