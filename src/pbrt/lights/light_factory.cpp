#include "pbrt/lights/light_factory.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pbrt/lights/diffuse_area_light.h"
#include "pbrt/lights/infinite_lights.h"
#include "pbrt/lights/light_image.h"
#include "pbrt/lights/point_lights.h"
#include "pbrt/math/warps.h"
#include "pbrt/shapes/extent.h"
#include "pbrt/spectra/spectrum_params.h"

namespace pbrt {
namespace {

void RequirePosition(const ParamSet &set, const LightContext &context, const Point3 &p) {
    RequireReach(set.What(), context.renderFromLight, Bounds3(p), set.Loc());
}

/// `scale` such that an emission of scale 1 is one photometric unit, times `factor`. Throws if the emission times the
/// result exceeds single precision.
Float PhotometricScale(const ParamSet &set, Float scale, const Spectrum &emission, const char *name, Float factor = 1) {
    const Float photometric = SpectrumToPhotometric(emission);
    // Black lights are legal; other emission without luminance cannot be photometrically normalized.
    if (!(photometric > 0) && emission.MaxValue() > 0) throw NoLuminanceError(set, name, emission);
    const Float result = (photometric > 0 ? scale / photometric : 0) * factor;
    if (!std::isfinite(result) || !std::isfinite(result * emission.MaxValue()))
        throw set.Error(set.Has("scale") ? "scale" : name,
                        "\"{}\" times all that scales it is larger than the largest number, {:.4g}.", name,
                        std::numeric_limits<Float>::max());
    return result;
}

void RequireSquare(const ParamSet &set, const LightImage &light) {
    Point2i n = light.image.Resolution();
    if (n.x != n.y)
        throw set.Error("filename",
                        "\"{}\" has {} x {} pixels; an image of directions must be square, in the equal-area "
                        "octahedral layout (imgtool makeequiarea converts latitude-longitude images).",
                        light.name, n.x, n.y);
}

SpectrumPtr OrIlluminant(const SpectrumParam &given, const LightContext &context) {
    return given ? given.Make(context.files) : context.colorSpace.IlluminantPtr();
}

constexpr SpectrumParam kEmission{SpectrumUse::Illuminant};
constexpr Items kPosition{ParamType::Point3, kCoordinateRange};
constexpr const char *kScaleHelp = "factor", *kPowerHelp = "if above 0: total power, in watts";
constexpr const char *kIlluminanceHelp = "if above 0: total illuminance, in lux";

struct IntensityParams {
    SpectrumParam intensity = kEmission;
    Float scale = 1, power = -1;
    void Describe(auto &&v) {
        v("I", intensity, "intensity; default: illuminant of the colour space");
        v("scale", scale, kBrightnessRange, kScaleHelp);
        v("power", power, kPowerRange, kPowerHelp);
    }
};

struct DirectionParams {
    Point3 from{0, 0, 0}, to{0, 0, 1};
    void Describe(auto &&v) {
        v("from", from, kPosition, "where light comes from");
        v("to", to, kPosition, "point that it shines to");
    }
    Vector3 UnitVector(const ParamSet &set) const {
        const Vector3 d = to - from;
        if (!(LengthSquared(d) > 0))
            throw set.Error(set.Has("to") ? "to" : "from",
                            "\"from\" and \"to\" are the same point, so the light has no direction.");
        return Normalize(d);
    }
};

struct PointParams : IntensityParams {
    Point3 from{0, 0, 0};
    void Describe(auto &&v) {
        IntensityParams::Describe(v);
        v("from", from, kPosition, "position");
    }
};

std::unique_ptr<Light> MakePoint(const PointParams &p, const ParamSet &set, const LightContext &context) {
    SpectrumPtr intensity = OrIlluminant(p.intensity, context);
    const Float factor = p.power > 0 ? p.power / (4 * Pi) : 1;
    const Float scale = PhotometricScale(set, p.scale, *intensity, "I", factor);
    RequirePosition(set, context, p.from);
    return std::make_unique<PointLight>(context.renderFromLight.Point(p.from), InternSpectrum(*intensity), scale);
}

struct SpotParams : IntensityParams {
    DirectionParams direction;
    Float coneAngle = 30, delta = 5;
    void Describe(auto &&v) {
        IntensityParams::Describe(v);
        direction.Describe(v);
        v("coneangle", coneAngle, Positive(180, "degrees"), "angle between axis and border");
        v("conedeltaangle", delta, AnyFloat("degrees"), "angle of the falloff inside the border");
    }
};

std::unique_ptr<Light> MakeSpot(const SpotParams &p, const ParamSet &set, const LightContext &context) {
    SpectrumPtr intensity = OrIlluminant(p.intensity, context);
    if (!(p.delta >= 0 && p.delta <= 2 * p.coneAngle))
        throw set.Error("conedeltaangle", "\"conedeltaangle\" is {}; it must be from 0 to twice the cone angle ({}).",
                        p.delta, 2 * p.coneAngle);
    RequirePosition(set, context, p.direction.from);
    // A falloff wider than the cone starts on the other side of the axis; only its cosine matters.
    Float falloffStart = std::abs(p.coneAngle - p.delta);
    const Float factor = p.power > 0 ? p.power / SpotLight::PowerPerIntensity(p.coneAngle, falloffStart) : 1;
    const Float scale = PhotometricScale(set, p.scale, *intensity, "I", factor);
    return std::make_unique<SpotLight>(context.renderFromLight, p.direction.from, p.direction.UnitVector(set),
                                       InternSpectrum(*intensity), scale, p.coneAngle, falloffStart);
}

struct DistantParams {
    SpectrumParam radiance = kEmission;
    Float scale = 1, illuminance = -1;
    DirectionParams direction;
    void Describe(auto &&v) {
        v("L", radiance, "radiance; default: illuminant of the colour space");
        v("scale", scale, kBrightnessRange, kScaleHelp);
        v("illuminance", illuminance, kPowerRange, kIlluminanceHelp);
        direction.Describe(v);
    }
};

std::unique_ptr<Light> MakeDistant(const DistantParams &p, const ParamSet &set, const LightContext &context) {
    SpectrumPtr radiance = OrIlluminant(p.radiance, context);
    const Float scale = PhotometricScale(set, p.scale, *radiance, "L", p.illuminance > 0 ? p.illuminance : 1);
    Vector3 wi = Normalize(context.renderFromLight.Vector(-p.direction.UnitVector(set)));
    return std::make_unique<DistantLight>(wi, InternSpectrum(*radiance), scale);
}

/// Factor to reach `power`, from the power emitted at scale 1.
Float PowerFactor(const ParamSet &set, Float power, Float emitted, const std::string &image) {
    if (!(emitted > 0)) throw set.Error("power", "\"{}\" is black, so \"power\" cannot be reached.", image);
    return power / emitted;
}

struct GoniometricParams : IntensityParams {
    std::string filename;
    void Describe(auto &&v) {
        IntensityParams::Describe(v);
        v("filename", filename, "square image of factors by direction");
    }
};

std::unique_ptr<Light> MakeGoniometric(const GoniometricParams &p, const ParamSet &set, const LightContext &context) {
    SpectrumPtr intensity = OrIlluminant(p.intensity, context);
    RequirePosition(set, context, {0, 0, 0});
    LightImage light;
    if (p.filename.empty()) {
        set.Warn(context.sink, "", "no \"filename\", so the light is the same in all directions.");
        light.image = Image(PixelFormat::Float, {1, 1}, {"Y"});
        light.image.Set({0, 0}, 0, 1);
    } else {
        light = set.At("filename", [&] { return ReadIntensityImage(context.files.Resolve(p.filename)); });
        RequireSquare(set, light);
    }
    Float factor = 1;
    if (p.power > 0) factor = PowerFactor(set, p.power, 4 * Pi * GoniometricLight::Mean(light.image), light.name);
    const Float scale = PhotometricScale(set, p.scale, *intensity, "I", factor);
    return std::make_unique<GoniometricLight>(context.renderFromLight, InternSpectrum(*intensity), scale,
                                              std::move(light.image));
}

struct ProjectionParams {
    std::string filename;
    Float fov = 90, scale = 1, power = -1;
    void Describe(auto &&v) {
        v("filename", filename, Required(), "projected image");
        v("fov", fov, Range<Float>{0, 180, true, true, "degrees"}, "field of view along the shorter side");
        v("scale", scale, kBrightnessRange, kScaleHelp);
        v("power", power, kPowerRange, kPowerHelp);
    }
};

std::unique_ptr<Light> MakeProjection(const ProjectionParams &p, const ParamSet &set, const LightContext &context) {
    RequirePosition(set, context, {0, 0, 0});
    LightImage light = set.At("filename", [&] { return ReadLightImage(context.files.Resolve(p.filename)); });
    Float factor = 1;
    if (p.power > 0)
        factor = PowerFactor(set, p.power, ProjectionLight::LuminancePower(light.image, *light.colorSpace, p.fov),
                             light.name);
    const Float scale = PhotometricScale(set, p.scale, light.colorSpace->Illuminant(), "filename", factor);
    return std::make_unique<ProjectionLight>(context.renderFromLight, std::move(light.image), *light.colorSpace, scale,
                                             p.fov);
}

/// Stock pbrt-v4's illuminance of an environment light on a surface that faces its +z. It uses 2 pi sr for the whole
/// image, half of the sphere's 4 pi, so images are twice as bright as specified; kept for compatibility. Behind a
/// portal, stock takes the channels in file order, which is B, G, R in EXR; its image of conformance scene
/// lights/portal_illuminance confirms these weights to five digits.
Float MeasureIlluminance(const LightImage &light, bool hasPortal) {
    Rgb weights = light.colorSpace->Luminance();
    if (hasPortal && (light.name.ends_with(".exr") || light.name.ends_with(".EXR"))) std::swap(weights.x, weights.z);
    Point2i n = light.image.Resolution();
    double sum = 0;
    ForEachPixel(light.image, [&](Point2i p) {
        Float cosTheta = EqualAreaSquareToSphere(PixelCenter(p.x, p.y, n)).z;
        if (cosTheta > 0) sum += double(glm::dot(LightPixel(light.image, p), weights) * cosTheta);
    });
    return Float(sum * 2 * std::numbers::pi / (double(n.x) * double(n.y)));
}

struct InfiniteParams {
    SpectrumParam radiance = kEmission;
    std::string filename;
    Float scale = 1, illuminance = -1;
    std::vector<Point3> portal;
    void Describe(auto &&v) {
        v("L", radiance, "radiance; default without image: illuminant of the colour space");
        v("filename", filename, "square image, equal-area octahedral");
        v("scale", scale, kBrightnessRange, kScaleHelp);
        v("illuminance", illuminance, kPowerRange, kIlluminanceHelp);
        v("portal", portal, kPosition, "corners of a rectangular portal, in world space");
    }
};

std::optional<std::array<Point3, 4>> GetPortal(const std::vector<Point3> &given, const ParamSet &set,
                                               const LightContext &context) {
    if (given.empty()) return {};
    if (given.size() != 4)
        throw set.Error("portal", "\"portal\" takes the 4 corners of a rectangle, found {} points.", given.size());
    std::array<Point3, 4> p;
    std::copy(given.begin(), given.end(), p.begin());
    Vector3 x = p[3] - p[0], y = p[1] - p[0];
    Float size2 = LengthSquared(x) * LengthSquared(y);
    if (!(size2 > 0 && std::isfinite(size2) && LengthSquared(Cross(x, y)) > Float(1e-12) * size2))
        throw set.Error("portal", "the corners of \"portal\" do not span a rectangle.");
    if (!PortalLight::IsRectangle(p))
        set.Warn(context.sink, "portal",
                 "\"portal\" is not a rectangle; the one nearest to its sides at the first corner is used.");
    return p;
}

/// "L" as an image, for lights that need one; luminance 1 unless it is an "rgb".
LightImage ConstantImage(const SpectrumParam &L, const ParamSet &set, const LightContext &context) {
    LightImage light;
    light.name.assign(1, 'L');
    Rgb rgb(0);
    const SpectrumPtr radiance = L.Make(context.files);
    if (L.given->type == ParamType::Rgb) {
        rgb = {L.given->floats[0], L.given->floats[1], L.given->floats[2]};
        light.colorSpace = ColorSpace::Find(L.given->colorSpace);
    } else {
        light.colorSpace = &context.colorSpace;
        Xyz xyz = SpectrumToXyz(*radiance);
        if (xyz.y > 0) rgb = light.colorSpace->ToRgb(xyz / xyz.y);
        set.Warn(context.sink, "L",
                 fmt::format("behind a portal only the colour of \"L\" is used: rgb {:.4g} {:.4g} {:.4g}.", rgb.x,
                             rgb.y, rgb.z));
    }
    // High resolution, so that sampling resolves the light visible through each part of the portal.
    light.image = Image(PixelFormat::Float, {32, 32}, {"R", "G", "B"});
    ForEachValue(light.image, [&](Point2i p, int c) { light.image.Set(p, c, rgb[c]); });
    return light;
}

void RequireOneEmission(const SpectrumParam &L, const std::string &filename, const ParamSet &set) {
    if (L && !filename.empty()) throw set.Error("filename", "\"L\" and \"filename\" exclude each other.");
}

std::unique_ptr<Light> MakeInfinite(const InfiniteParams &p, const ParamSet &set, const LightContext &context) {
    const bool hasImage = !p.filename.empty();
    std::optional<std::array<Point3, 4>> portal = GetPortal(p.portal, set, context);
    RequireOneEmission(p.radiance, p.filename, set);
    if (portal && !p.radiance && !hasImage) throw set.Error("portal", "a portal needs \"L\" or \"filename\".");
    if (!hasImage && !portal) {
        SpectrumPtr radiance = OrIlluminant(p.radiance, context);
        const Float factor = p.illuminance > 0 ? p.illuminance / Pi : 1;
        const Float scale = PhotometricScale(set, p.scale, *radiance, "L", factor);
        return std::make_unique<UniformInfiniteLight>(InternSpectrum(*radiance), scale);
    }

    LightImage light = hasImage ? set.At("filename", [&] { return ReadLightImage(context.files.Resolve(p.filename)); })
                                : ConstantImage(p.radiance, set, context);
    if (hasImage) RequireSquare(set, light);
    Float factor = 1;
    if (p.illuminance > 0) {
        const Float measured = MeasureIlluminance(light, portal.has_value());
        if (!(measured > 0))
            throw set.Error("illuminance", "\"{}\" is black above the horizon, so \"illuminance\" cannot be reached.",
                            light.name);
        factor = p.illuminance / measured;
    }
    const Float scale = PhotometricScale(set, p.scale, light.colorSpace->Illuminant(), "filename", factor);
    if (portal)
        return std::make_unique<PortalLight>(context.renderFromLight, light.image, *light.colorSpace, scale, *portal,
                                             context.renderFromWorld);
    return std::make_unique<ImageInfiniteLight>(context.renderFromLight, std::move(light.image), *light.colorSpace,
                                                scale);
}

struct DiffuseAreaParams {
    SpectrumParam radiance = kEmission;
    std::string filename;
    Float scale = 1, power = -1;
    bool twoSided = false;
    void Describe(auto &&v) {
        v("L", radiance, "radiance; default without image: illuminant of the colour space");
        v("filename", filename, "image over (u, v), v upwards");
        v("scale", scale, kBrightnessRange, kScaleHelp);
        v("twosided", twoSided, "emits on both sides");
        v("power", power, kPowerRange, "if above 0: power per primitive, in watts");
    }
};

AreaLightMaker MakeDiffuseArea(const DiffuseAreaParams &p, const ParamSet &set, const LightContext &context) {
    RequireOneEmission(p.radiance, p.filename, set);
    auto emission = std::make_shared<AreaEmission>();
    emission->twoSided = p.twoSided;
    emission->power = p.power;
    const SpectrumPtr radiance = OrIlluminant(p.radiance, context);
    emission->scale = PhotometricScale(set, p.scale, *radiance, "L");
    if (p.filename.empty()) {
        emission->spectrum = InternSpectrum(*radiance);
    } else {
        LightImage light = set.At("filename", [&] { return ReadLightImage(context.files.Resolve(p.filename)); });
        emission->image = std::move(light.image);
        emission->colorSpace = light.colorSpace;
    }
    emission->Summarise();
    return [emission](std::span<const Shape *const> shapes, const FloatTexture *alpha) {
        return std::make_unique<DiffuseAreaLight>(emission, shapes, alpha);
    };
}

/// Registers a directional light, for which a singular transformation is an error.
template <class P, class F>
void AddDirected(LightFactories &table, const char *name, F make) {
    table.Add<P>(name, "", [make](const P &p, const ParamSet &set, const LightContext &context) {
        if (context.renderFromLight.IsSingular())
            throw set.Error("", "the current transformation flattens it (its matrix is singular).");
        return make(p, set, context);
    });
}

}  // namespace

const LightFactories &Lights() {
    static const LightFactories table("LightSource", [](LightFactories &t) {
        t.Add<PointParams>("point", "", MakePoint);
        AddDirected<SpotParams>(t, "spot", MakeSpot);
        AddDirected<DistantParams>(t, "distant", MakeDistant);
        AddDirected<GoniometricParams>(t, "goniometric", MakeGoniometric);
        AddDirected<ProjectionParams>(t, "projection", MakeProjection);
        AddDirected<InfiniteParams>(t, "infinite", MakeInfinite);
    });
    return table;
}

const AreaLightFactories &AreaLights() {
    static const AreaLightFactories table(
        "AreaLightSource", [](AreaLightFactories &t) { t.Add<DiffuseAreaParams>("diffuse", "", MakeDiffuseArea); });
    return table;
}

}  // namespace pbrt
