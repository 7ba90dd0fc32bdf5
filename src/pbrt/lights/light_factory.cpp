#include "pbrt/lights/light_factory.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pbrt/lights/diffuse_area_light.h"
#include "pbrt/lights/distant_light.h"
#include "pbrt/lights/goniometric_light.h"
#include "pbrt/lights/infinite_light.h"
#include "pbrt/lights/light_image.h"
#include "pbrt/lights/light_spectrum.h"
#include "pbrt/lights/point_light.h"
#include "pbrt/lights/portal_light.h"
#include "pbrt/lights/projection_light.h"
#include "pbrt/lights/spot_light.h"
#include "pbrt/math/warps.h"
#include "pbrt/shapes/extent.h"
#include "pbrt/spectra/spectrum_params.h"

namespace pbrt {

namespace {

/// What the parameters of every light have in common.
struct LightInput {
    const ParamSet &params;
    const Transform &renderFromLight, &renderFromWorld;
    const ColorSpace &colorSpace;
    const FileResolver &files;
    DiagnosticSink &sink;

    SpectrumPtr Emission(const char *name) const {
        return GetSpectrum(params, name, colorSpace.IlluminantPtr(), SpectrumUse::Illuminant, files);
    }
    Point3 GetPoint(const char *name, const Point3 &defaultValue) const {
        std::span<const Float> v = params.GetFloats(name, ParamType::Point3);
        if (v.empty()) return defaultValue;
        if (v.size() != 3)
            throw UserError(
                fmt::format("{}: expected one point for \"point3 {}\", found {}.", params.What(), name, v.size() / 3),
                params.LocOf(name));
        for (Float coordinate : v) params.Require(name, coordinate, kCoordinateRange);
        return {v[0], v[1], v[2]};
    }
    /// An error if the light is too far away.
    void RequirePosition(const Point3 &p) const {
        RequireReach(params.What(), renderFromLight, Bounds3(p), params.Loc());
    }
    /// Unit vector between the points "from" and "to".
    Vector3 FromTo(const Point3 &from, const Point3 &to) const {
        Vector3 d = to - from;
        if (!(LengthSquared(d) > 0))
            throw UserError(fmt::format("{}: \"from\" and \"to\" are the same point, so the light has no direction.",
                                        params.What()),
                            params.LocOf(params.Has("to") ? "to" : "from"));
        return Normalize(d);
    }
};

/// An error if an emission so scaled is too bright for single precision.
Float RequireFinite(const LightInput &in, Float scale, const Spectrum &emission, const char *name) {
    if (!std::isfinite(scale) || !std::isfinite(scale * emission.MaxValue()))
        throw UserError(fmt::format("{}: \"{}\" times all that scales it is larger than the largest number, {:.4g}.",
                                    in.params.What(), name, std::numeric_limits<Float>::max()),
                        in.params.LocOf(in.params.Has("scale") ? "scale" : name));
    return scale;
}

/// `scale` so that an emission of scale 1 is one photometric unit.
Float PhotometricScale(const LightInput &in, const Spectrum &emission, const char *name) {
    Float scale = in.params.GetFloat("scale", 1, kBrightnessRange), photometric = SpectrumToPhotometric(emission);
    if (!(photometric > 0)) {
        // Black light is legal; anything else that has no luminous part cannot be brought to photometric units.
        if (!(emission.MaxValue() > 0)) return 0;
        throw UserError(
            fmt::format("{}: \"{}\" emits nothing that the eye can see, so it cannot be scaled to photometric units.",
                        in.params.What(), name),
            in.params.LocOf(name));
    }
    return scale / photometric;
}

void RequireSquare(const LightInput &in, const LightImage &light) {
    Point2i n = light.image.Resolution();
    if (n.x != n.y)
        throw UserError(
            fmt::format(
                "\"{}\" has {} x {} pixels; an image of directions must be square, in the equal-area octahedral "
                "layout (imgtool makeequiarea converts latitude-longitude images).",
                light.name, n.x, n.y),
            in.params.LocOf("filename"));
}

std::unique_ptr<Light> MakePoint(const LightInput &in) {
    SpectrumPtr intensity = in.Emission("I");
    Float scale = PhotometricScale(in, *intensity, "I");
    Float power = in.params.GetFloat("power", -1, kPowerRange);
    if (power > 0) scale *= power / (4 * Pi);
    RequireFinite(in, scale, *intensity, "I");
    Point3 from = in.GetPoint("from", {0, 0, 0});
    in.RequirePosition(from);
    return std::make_unique<PointLight>(in.renderFromLight.Point(from), InternSpectrum(*intensity), scale);
}

std::unique_ptr<Light> MakeSpot(const LightInput &in) {
    SpectrumPtr intensity = in.Emission("I");
    Float scale = PhotometricScale(in, *intensity, "I");
    Float coneAngle = in.params.GetFloat("coneangle", 30, Positive(180)),
          delta = in.params.GetFloat("conedeltaangle", 5);
    Float power = in.params.GetFloat("power", -1, kPowerRange);
    Point3 from = in.GetPoint("from", {0, 0, 0}), to = in.GetPoint("to", {0, 0, 1});
    if (!(delta >= 0 && delta <= 2 * coneAngle))
        throw UserError(fmt::format("{}: \"conedeltaangle\" is {}; it must be from 0 to twice the cone angle ({}).",
                                    in.params.What(), delta, 2 * coneAngle),
                        in.params.LocOf("conedeltaangle"));
    in.RequirePosition(from);
    // A falloff wider than the cone starts on the other side of the axis; only its cosine counts.
    Float falloffStart = std::abs(coneAngle - delta);
    if (power > 0) scale *= power / SpotLight::PowerPerIntensity(coneAngle, falloffStart);
    RequireFinite(in, scale, *intensity, "I");
    return std::make_unique<SpotLight>(in.renderFromLight, from, in.FromTo(from, to), InternSpectrum(*intensity), scale,
                                       coneAngle, falloffStart);
}

std::unique_ptr<Light> MakeDistant(const LightInput &in) {
    SpectrumPtr radiance = in.Emission("L");
    Float scale = PhotometricScale(in, *radiance, "L");
    Float illuminance = in.params.GetFloat("illuminance", -1, kPowerRange);
    Point3 from = in.GetPoint("from", {0, 0, 0}), to = in.GetPoint("to", {0, 0, 1});
    if (illuminance > 0) scale *= illuminance;
    RequireFinite(in, scale, *radiance, "L");
    Vector3 wi = Normalize(in.renderFromLight.Vector(-in.FromTo(from, to)));
    return std::make_unique<DistantLight>(wi, InternSpectrum(*radiance), scale);
}

/// `power` over what the light would emit at scale 1.
Float PowerFactor(const LightInput &in, Float power, Float emitted, const std::string &image) {
    if (!(emitted > 0))
        throw UserError(fmt::format("\"{}\" is black, so \"power\" cannot be reached.", image),
                        in.params.LocOf("power"));
    return power / emitted;
}

std::unique_ptr<Light> MakeGoniometric(const LightInput &in) {
    SpectrumPtr intensity = in.Emission("I");
    Float scale = PhotometricScale(in, *intensity, "I");
    Float power = in.params.GetFloat("power", -1, kPowerRange);
    in.RequirePosition({0, 0, 0});
    LightImage light;
    if (in.params.GetString("filename", "").empty()) {
        in.sink.Warning(
            in.params.LocOf(""),
            fmt::format("{}: no \"filename\", so the light is the same in all directions.", in.params.What()));
        light.image = Image(PixelFormat::Float, {1, 1}, {"Y"});
        light.image.Set({0, 0}, 0, 1);
    } else {
        light = ReadIntensityImage(in.params, "filename", in.files);
        RequireSquare(in, light);
    }
    if (power > 0) scale *= PowerFactor(in, power, 4 * Pi * GoniometricLight::Mean(light.image), light.name);
    RequireFinite(in, scale, *intensity, "I");
    return std::make_unique<GoniometricLight>(in.renderFromLight, InternSpectrum(*intensity), scale,
                                              std::move(light.image));
}

std::unique_ptr<Light> MakeProjection(const LightInput &in) {
    Float fov = in.params.GetFloat("fov", 90, {0, 180, true, true}),
          power = in.params.GetFloat("power", -1, kPowerRange);
    in.params.GetFloat("scale", 1);
    if (in.params.GetString("filename", "").empty())
        throw UserError(fmt::format("{}: \"filename\" is missing: the image to be projected.", in.params.What()),
                        in.params.LocOf("filename"));
    in.RequirePosition({0, 0, 0});
    LightImage light = ReadLightImage(in.params, "filename", in.files);
    Float scale = PhotometricScale(in, light.colorSpace->Illuminant(), "filename");
    if (power > 0)
        scale *=
            PowerFactor(in, power, ProjectionLight::LuminancePower(light.image, *light.colorSpace, fov), light.name);
    RequireFinite(in, scale, light.colorSpace->Illuminant(), "filename");
    return std::make_unique<ProjectionLight>(in.renderFromLight, std::move(light.image), *light.colorSpace, scale, fov);
}

/// What stock pbrt-v4 takes for the illuminance of an environment on a surface that faces its +z. It counts 2 pi sr for
/// the whole image, half of the sphere's 4 pi, so pictures come out twice as bright as asked; kept to match them.
Float MeasureIlluminance(const LightImage &light, const Rgb &weights) {
    Point2i n = light.image.Resolution();
    double sum = 0;
    for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) {
            Float cosTheta = EqualAreaSquareToSphere(PixelCenter(x, y, n)).z;
            if (cosTheta > 0) sum += static_cast<double>(glm::dot(LightPixel(light.image, {x, y}), weights) * cosTheta);
        }
    return static_cast<Float>(sum * 2 * std::numbers::pi / (static_cast<double>(n.x) * static_cast<double>(n.y)));
}

/// What stock pbrt-v4 multiplies R, G and B by when it measures an illuminance. Behind a portal it takes the channels
/// in the order of the file, and EXR files hold them as B, G, R; its picture of conformance scene
/// lights/portal_illuminance shows these weights to five digits.
Rgb IlluminanceWeights(const LightImage &light, bool hasPortal) {
    const Rgb luminance = light.colorSpace->Luminance();
    const bool exr = light.name.ends_with(".exr") || light.name.ends_with(".EXR");
    return hasPortal && exr ? Rgb(luminance.z, luminance.y, luminance.x) : luminance;
}

/// The corners of "portal", if there is one.
std::optional<std::array<Point3, 4>> GetPortal(const LightInput &in) {
    std::span<const Float> v = in.params.GetFloats("portal", ParamType::Point3);
    if (v.empty()) return {};
    FileLoc loc = in.params.LocOf("portal");
    if (v.size() != 12)
        throw UserError(fmt::format("{}: \"portal\" takes the 4 corners of a rectangle, found {} points.",
                                    in.params.What(), v.size() / 3),
                        loc);
    for (Float coordinate : v) in.params.Require("portal", coordinate, kCoordinateRange);
    std::array<Point3, 4> p;
    for (size_t i = 0; i < 4; ++i) p[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
    Vector3 x = p[3] - p[0], y = p[1] - p[0];
    Float size2 = LengthSquared(x) * LengthSquared(y);
    if (!(size2 > 0 && std::isfinite(size2) && LengthSquared(Cross(x, y)) > Float(1e-12) * size2))
        throw UserError(fmt::format("{}: the corners of \"portal\" do not span a rectangle.", in.params.What()), loc);
    if (!PortalLight::IsRectangle(p))
        in.sink.Warning(
            loc,
            fmt::format("{}: \"portal\" is not a rectangle; the one nearest to its sides at the first corner is used.",
                        in.params.What()));
    return p;
}

/// "L" as an image, for lights that need one; of luminance 1 unless it is an "rgb".
LightImage ConstantImage(const LightInput &in, const Spectrum &radiance) {
    LightImage light;
    light.name.assign(1, 'L');
    Rgb rgb(0);
    if (dynamic_cast<const RgbIlluminantSpectrum *>(&radiance)) {
        const Param &p = *in.params.Find("L", ParamType::Rgb);
        rgb = {p.floats[0], p.floats[1], p.floats[2]};
        light.colorSpace = ColorSpace::Find(p.colorSpace);
    } else {
        light.colorSpace = &in.colorSpace;
        Xyz xyz = SpectrumToXyz(radiance);
        if (xyz.y > 0) rgb = light.colorSpace->ToRgb(xyz / xyz.y);
        in.sink.Warning(in.params.LocOf("L"),
                        fmt::format("{}: with a portal \"L\" is taken as the colour it has: rgb {:.4g} {:.4g} {:.4g}.",
                                    in.params.What(), rgb.x, rgb.y, rgb.z));
    }
    // Many pixels, so that sampling knows how much of the sky each part of the portal shows.
    light.image = Image(PixelFormat::Float, {32, 32}, {"R", "G", "B"});
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x)
            for (int c = 0; c < 3; ++c) light.image.Set({x, y}, c, rgb[c]);
    return light;
}

std::unique_ptr<Light> MakeInfinite(const LightInput &in) {
    const ParamSet &params = in.params;
    SpectrumPtr radiance = GetSpectrum(params, "L", nullptr, SpectrumUse::Illuminant, in.files);
    bool hasImage = !params.GetString("filename", "").empty();
    Float illuminance = params.GetFloat("illuminance", -1, kPowerRange);
    params.GetFloat("scale", 1);
    std::optional<std::array<Point3, 4>> portal = GetPortal(in);
    if (radiance && hasImage)
        throw UserError(fmt::format("{}: \"L\" and \"filename\" exclude each other.", params.What()),
                        params.LocOf("filename"));
    if (portal && !radiance && !hasImage)
        throw UserError(fmt::format("{}: a portal needs \"L\" or \"filename\".", params.What()),
                        params.LocOf("portal"));
    if (!hasImage && !portal) {
        if (!radiance) radiance = in.colorSpace.IlluminantPtr();
        Float scale = PhotometricScale(in, *radiance, "L");
        if (illuminance > 0) scale *= illuminance / Pi;
        RequireFinite(in, scale, *radiance, "L");
        return std::make_unique<UniformInfiniteLight>(InternSpectrum(*radiance), scale);
    }

    LightImage light = hasImage ? ReadLightImage(params, "filename", in.files) : ConstantImage(in, *radiance);
    if (hasImage) RequireSquare(in, light);
    Float scale = PhotometricScale(in, light.colorSpace->Illuminant(), "filename");
    if (illuminance > 0) {
        Float measured = MeasureIlluminance(light, IlluminanceWeights(light, portal.has_value()));
        if (!(measured > 0))
            throw UserError(
                fmt::format("\"{}\" is black above the horizon, so \"illuminance\" cannot be reached.", light.name),
                params.LocOf("illuminance"));
        scale *= illuminance / measured;
    }
    RequireFinite(in, scale, light.colorSpace->Illuminant(), "filename");
    if (portal)
        return std::make_unique<PortalLight>(in.renderFromLight, light.image, *light.colorSpace, scale, *portal,
                                             in.renderFromWorld);
    return std::make_unique<ImageInfiniteLight>(in.renderFromLight, std::move(light.image), *light.colorSpace, scale);
}

}  // namespace

const std::vector<std::string> &SupportedLights() {
    static const std::vector<std::string> names = {"distant", "goniometric", "infinite", "point", "projection", "spot"};
    return names;
}

std::unique_ptr<Light> MakeLight(const std::string &type, const ParamSet &params, const Transform &renderFromLight,
                                 const Transform &renderFromWorld, const ColorSpace &colorSpace,
                                 const FileResolver &files, DiagnosticSink &sink) {
    LightInput in{params, renderFromLight, renderFromWorld, colorSpace, files, sink};
    if (type != "point" && renderFromLight.IsSingular())  // the others have a direction
        throw UserError(
            fmt::format("{}: the current transformation flattens it (its matrix is singular).", params.What()),
            params.Loc());
    if (type == "point") return MakePoint(in);
    if (type == "spot") return MakeSpot(in);
    if (type == "distant") return MakeDistant(in);
    if (type == "infinite") return MakeInfinite(in);
    if (type == "goniometric") return MakeGoniometric(in);
    if (type == "projection") return MakeProjection(in);

    params.MarkAllUsed();
    throw UserError(fmt::format("\"{}\" is not a light source; {}.", type, ListChoices(type, SupportedLights())),
                    params.LocOf(""));
}

struct AreaLightMaker::Impl {
    std::shared_ptr<const AreaEmission> emission;
};

AreaLightMaker::AreaLightMaker(const std::string &type, const ParamSet &params, const ColorSpace &colorSpace,
                               const FileResolver &files, DiagnosticSink &sink)
    : impl_(std::make_unique<Impl>()) {
    if (type != "diffuse") {
        params.MarkAllUsed();
        throw UserError(fmt::format("\"{}\" is not an area light source; {}.", type, ListChoices(type, {"diffuse"})),
                        params.LocOf(""));
    }
    auto emission = std::make_shared<AreaEmission>();
    const Transform identity;
    LightInput in{params, identity, identity, colorSpace, files, sink};
    SpectrumPtr radiance = GetSpectrum(params, "L", nullptr, SpectrumUse::Illuminant, files);
    bool hasImage = !params.GetString("filename", "").empty();
    emission->twoSided = params.GetBool("twosided", false);
    emission->power = params.GetFloat("power", -1, kPowerRange);
    params.GetFloat("scale", 1);
    if (radiance && hasImage)
        throw UserError(fmt::format("{}: \"L\" and \"filename\" exclude each other.", params.What()),
                        params.LocOf("filename"));
    if (!radiance) radiance = colorSpace.IlluminantPtr();
    emission->scale = RequireFinite(in, PhotometricScale(in, *radiance, "L"), *radiance, "L");
    if (hasImage) {
        LightImage light = ReadLightImage(params, "filename", files);
        emission->image = std::move(light.image);
        emission->colorSpace = light.colorSpace;
    } else {
        emission->spectrum = InternSpectrum(*radiance);
    }
    emission->Summarise();
    impl_->emission = std::move(emission);
}

AreaLightMaker::~AreaLightMaker() = default;
AreaLightMaker::AreaLightMaker(AreaLightMaker &&) noexcept = default;

std::unique_ptr<Light> AreaLightMaker::Make(std::span<const Shape *const> shapes, const FloatTexture *alpha) const {
    return std::make_unique<DiffuseAreaLight>(impl_->emission, shapes, alpha);
}

}  // namespace pbrt
