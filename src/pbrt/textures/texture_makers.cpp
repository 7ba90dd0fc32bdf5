#include "pbrt/textures/texture_makers.h"

#include "pbrt/core/files.h"
#include "pbrt/textures/checkerboard_texture.h"
#include "pbrt/textures/image_texture.h"
#include "pbrt/textures/noise_textures.h"

namespace pbrt {

namespace {

/// Makers that are the same for both families ask their operands through one of these.
struct FloatMaker {
    using Ptr = FloatTexturePtr;
    template <template <class, class, class...> class T>
    using Texture = FloatFamily<T>;
    const TextureRequest &request;

    Ptr Operand(const std::string &name, Float defaultValue) const { return request.floatTexture(name, defaultValue); }
    Ptr Value(const std::string &name, Float defaultValue) const {
        return std::make_shared<ConstantFloatTexture>(request.params.GetFloat(name, defaultValue));
    }
};

struct SpectrumMaker {
    using Ptr = SpectrumTexturePtr;
    template <template <class, class, class...> class T>
    using Texture = SpectrumFamily<T>;
    const TextureRequest &request;
    SpectrumUse use;

    Ptr Operand(const std::string &name, Float defaultValue) const {
        return request.spectrumTexture(name, std::make_shared<ConstantSpectrum>(defaultValue));
    }
    Ptr Value(const std::string &name, Float defaultValue) const {
        return std::make_shared<ConstantSpectrumTexture>(
            GetSpectrum(request.params, name, std::make_shared<ConstantSpectrum>(defaultValue), use, request.files));
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

/// A constant factor on an image becomes part of the image's own scale, before inversion and clamping, as in stock
/// pbrt-v4.
template <class Maker>
typename Maker::Ptr MakeScale(const Maker &maker) {
    auto texture = maker.Operand("tex", 1);
    FloatTexturePtr scale = maker.request.floatTexture("scale", 1);
    if (auto factor = scale->Constant())
        if (auto scaled = ScaleBy(texture, *factor)) return scaled;
    if constexpr (std::is_same_v<typename Maker::Ptr, FloatTexturePtr>)
        if (auto factor = texture->Constant())
            if (auto scaled = ScaleBy(scale, *factor)) return scaled;
    return std::make_shared<typename Maker::template Texture<ScaleTexture>>(std::move(texture), std::move(scale));
}

template <class Maker>
typename Maker::Ptr MakeMix(const Maker &maker) {
    auto first = maker.Operand("tex1", 0), second = maker.Operand("tex2", 1);
    FloatTexturePtr amount = maker.request.floatTexture("amount", Float(0.5));
    if (auto share = amount->Constant()) {
        if (*share == 0) return first;
        if (*share == 1) return second;
    }
    return std::make_shared<typename Maker::template Texture<MixTexture>>(std::move(first), std::move(second),
                                                                          std::move(amount));
}

template <class Maker>
typename Maker::Ptr MakeDirectionMix(const Maker &maker) {
    auto first = maker.Operand("tex1", 0), second = maker.Operand("tex2", 1);
    const ParamSet &params = maker.request.params;
    Vector3 direction = maker.request.renderFromTexture.Vector(ReadVector3(params, "dir", {0, 1, 0}));
    if (!(LengthSquared(direction) > 0))
        throw UserError(fmt::format("{}: \"dir\" has no direction.", params.What()), params.LocOf("dir"));
    return std::make_shared<typename Maker::template Texture<DirectionMixTexture>>(std::move(first), std::move(second),
                                                                                   direction);
}

template <class Maker>
typename Maker::Ptr MakeBilerp(const Maker &maker) {
    const TextureRequest &r = maker.request;
    TextureMapping2D mapping = ReadTextureMapping2D(r.params, r.renderFromTexture, r.sink);
    std::array<typename Maker::Ptr, 4> corners = {maker.Value("v00", 0), maker.Value("v01", 1), maker.Value("v10", 0),
                                                  maker.Value("v11", 1)};
    return std::make_shared<typename Maker::template Texture<BilerpTexture>>(std::move(mapping), std::move(corners));
}

PointMapping ReadPointMapping(const TextureRequest &r, const char *what) {
    if (r.renderFromTexture.IsSingular())
        throw UserError(fmt::format("{}: {} needs a transformation that can be inverted.", r.params.What(), what),
                        r.params.Loc());
    return PointMapping(r.renderFromTexture);
}

CheckerPattern ReadCheckerPattern(const TextureRequest &r) {
    int dimension = r.params.GetInt("dimension", 2);
    if (dimension == 2) return CheckerPattern(ReadTextureMapping2D(r.params, r.renderFromTexture, r.sink));
    if (dimension != 3)
        throw UserError(fmt::format("{}: \"dimension\" is {}; valid: 2, 3.", r.params.What(), dimension),
                        r.params.LocOf("dimension"));
    return CheckerPattern(ReadPointMapping(r, "dimension 3"));
}

template <class Maker>
typename Maker::Ptr MakeCheckerboard(const Maker &maker) {
    CheckerPattern pattern = ReadCheckerPattern(maker.request);
    auto first = maker.Operand("tex1", 1), second = maker.Operand("tex2", 0);
    return std::make_shared<typename Maker::template Texture<CheckerboardTexture>>(std::move(pattern), std::move(first),
                                                                                   std::move(second));
}

/// Stock pbrt-v4 shows "outside" in the dots and "inside" around them; scenes are made to look right there.
template <class Maker>
typename Maker::Ptr MakeDots(const Maker &maker) {
    const TextureRequest &r = maker.request;
    DotPattern pattern(ReadTextureMapping2D(r.params, r.renderFromTexture, r.sink));
    auto inside = maker.Operand("inside", 1), outside = maker.Operand("outside", 0);
    return std::make_shared<typename Maker::template Texture<DotsTexture>>(std::move(pattern), std::move(outside),
                                                                           std::move(inside));
}

NoiseOctaves ReadNoiseOctaves(const ParamSet &params) {
    NoiseOctaves octaves;
    octaves.count = params.GetInt("octaves", 8, {0, 64});  // each has nearly twice the frequency of the one before
    octaves.roughness = params.GetFloat("roughness", Float(0.5));
    return octaves;
}

MarbleSettings ReadMarbleSettings(const ParamSet &params) {
    MarbleSettings settings;
    settings.octaves = ReadNoiseOctaves(params);
    settings.scale = params.GetFloat("scale", 1);
    settings.variation = params.GetFloat("variation", Float(0.2));
    return settings;
}

ImageOverlay ReadImageOverlay(const TextureRequest &r) {
    ImageOverlay overlay;
    overlay.mapping = ReadTextureMapping2D(r.params, r.renderFromTexture, r.sink);
    overlay.scale = r.params.GetFloat("scale", 1);
    overlay.invert = r.params.GetBool("invert", false);
    MipMapKey key = ReadMipMapKey(r.params, r.files);
    FileLoc loc = r.params.LocOf("filename");
    if (!FileExists(key.path))
        throw MissingImageError(fmt::format("{}: file not found.", r.params.GetString("filename", "")), loc);
    try {
        overlay.image = r.images.GetMipMap(key);
    } catch (const UserError &e) {
        throw UserError(e.Diagnostics().front().message, loc);
    }
    return overlay;
}

template <class Maker>
typename Maker::Ptr MakeOfBothFamilies(const Maker &maker) {
    const std::string &name = maker.request.textureClass;
    if (name == "constant") return maker.Value("value", 1);
    if (name == "scale") return MakeScale(maker);
    if (name == "mix") return MakeMix(maker);
    if (name == "directionmix") return MakeDirectionMix(maker);
    if (name == "bilerp") return MakeBilerp(maker);
    if (name == "checkerboard") return MakeCheckerboard(maker);
    if (name == "dots") return MakeDots(maker);
    throw UserError(fmt::format("{}: there is no such class; {}.", maker.request.params.What(),
                                ListChoices(name, SupportedTextures())),
                    maker.request.params.Loc());
}

}  // namespace

MipMapKey ReadMipMapKey(const ParamSet &params, const FileResolver &files) {
    MipMapKey key;
    std::string file = params.GetString("filename", "");
    if (file.empty())
        throw UserError(fmt::format("{}: \"string filename\" is required.", params.What()), params.LocOf("filename"));
    key.path = files.Resolve(file);
    key.filter = *ParseTextureFilter(
        params.GetChoice("filter", "bilinear", {"point", "bilinear", "trilinear", "ewa", "EWA"}));
    key.maxAnisotropy = params.GetFloat("maxanisotropy", 8, Positive(1e6f));
    key.wrap = *ParseWrapMode(params.GetChoice("wrap", "repeat", {"repeat", "black", "clamp", "octahedralsphere"}));
    std::string encoding = params.GetString("encoding", "");
    if (params.Has("encoding")) {
        key.encoding = ColorEncoding::Parse(encoding);
        if (!key.encoding && !encoding.empty())
            throw UserError(fmt::format("{}: \"{}\" is no encoding; valid: sRGB, linear, \"gamma X\" with X above 0.",
                                        params.What(), encoding),
                            params.LocOf("encoding"));
    }
    return key;
}

FloatTexturePtr MakeFloatTexture(const TextureRequest &request) {
    if (request.textureClass == "imagemap") return std::make_shared<ImageFloatTexture>(ReadImageOverlay(request));
    if (request.textureClass == "windy") return std::make_shared<WindyTexture>(ReadPointMapping(request, "noise"));
    if (request.textureClass == "fbm")
        return std::make_shared<FbmTexture>(ReadPointMapping(request, "noise"), ReadNoiseOctaves(request.params));
    if (request.textureClass == "wrinkled")
        return std::make_shared<WrinkledTexture>(ReadPointMapping(request, "noise"), ReadNoiseOctaves(request.params));
    return MakeOfBothFamilies(FloatMaker{request});
}

SpectrumTexturePtr MakeSpectrumTexture(const TextureRequest &request, SpectrumUse use) {
    if (request.textureClass == "imagemap")
        return std::make_shared<ImageSpectrumTexture>(ReadImageOverlay(request), use);
    if (request.textureClass == "marble")
        return std::make_shared<MarbleTexture>(ReadPointMapping(request, "noise"), ReadMarbleSettings(request.params));
    return MakeOfBothFamilies(SpectrumMaker{request, use});
}

}  // namespace pbrt
