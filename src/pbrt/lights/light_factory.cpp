#include "pbrt/lights/light_factory.h"

#include <algorithm>

#include "pbrt/lights/diffuse_area_light.h"
#include "pbrt/lights/distant_light.h"
#include "pbrt/lights/infinite_light.h"
#include "pbrt/lights/light_image.h"
#include "pbrt/lights/light_spectrum.h"
#include "pbrt/lights/point_light.h"
#include "pbrt/lights/spot_light.h"
#include "pbrt/math/warps.h"
#include "pbrt/spectra/spectrum_params.h"

namespace pbrt {

namespace {

/// What the parameters of every light have in common.
struct LightInput {
    const ParamSet &params;
    const Transform &renderFromLight;
    const ColorSpace &colorSpace;
    const FileResolver &files;

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
        return {v[0], v[1], v[2]};
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

/// `scale` so that an emission of scale 1 is one photometric unit.
Float PhotometricScale(const LightInput &in, const Spectrum &emission, const char *name) {
    Float scale = in.params.GetFloat("scale", 1), photometric = SpectrumToPhotometric(emission);
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

std::unique_ptr<Light> MakePoint(const LightInput &in) {
    SpectrumPtr intensity = in.Emission("I");
    Float scale = PhotometricScale(in, *intensity, "I");
    Float power = in.params.GetFloat("power", -1);
    if (power > 0) scale *= power / (4 * Pi);
    Point3 from = in.GetPoint("from", {0, 0, 0});
    return std::make_unique<PointLight>(in.renderFromLight.Point(from), InternSpectrum(*intensity), scale);
}

std::unique_ptr<Light> MakeSpot(const LightInput &in) {
    SpectrumPtr intensity = in.Emission("I");
    Float scale = PhotometricScale(in, *intensity, "I");
    Float coneAngle = in.params.GetFloat("coneangle", 30), delta = in.params.GetFloat("conedeltaangle", 5);
    Float power = in.params.GetFloat("power", -1);
    Point3 from = in.GetPoint("from", {0, 0, 0}), to = in.GetPoint("to", {0, 0, 1});
    if (!(coneAngle > 0 && coneAngle <= 180))
        throw UserError(fmt::format("{}: \"coneangle\" is {}; it must be above 0 and at most 180 degrees.",
                                    in.params.What(), coneAngle),
                        in.params.LocOf("coneangle"));
    if (!(delta >= 0 && delta <= 2 * coneAngle))
        throw UserError(fmt::format("{}: \"conedeltaangle\" is {}; it must be from 0 to twice the cone angle ({}).",
                                    in.params.What(), delta, 2 * coneAngle),
                        in.params.LocOf("conedeltaangle"));
    // A falloff wider than the cone starts on the other side of the axis; only its cosine counts.
    Float falloffStart = std::abs(coneAngle - delta);
    if (power > 0) scale *= power / SpotLight::PowerPerIntensity(coneAngle, falloffStart);
    return std::make_unique<SpotLight>(in.renderFromLight, from, in.FromTo(from, to), InternSpectrum(*intensity), scale,
                                       coneAngle, falloffStart);
}

std::unique_ptr<Light> MakeDistant(const LightInput &in) {
    SpectrumPtr radiance = in.Emission("L");
    Float scale = PhotometricScale(in, *radiance, "L");
    Float illuminance = in.params.GetFloat("illuminance", -1);
    Point3 from = in.GetPoint("from", {0, 0, 0}), to = in.GetPoint("to", {0, 0, 1});
    if (illuminance > 0) scale *= illuminance;
    Vector3 wi = Normalize(in.renderFromLight.Vector(-in.FromTo(from, to)));
    return std::make_unique<DistantLight>(wi, InternSpectrum(*radiance), scale);
}

/// What stock pbrt-v4 takes for the illuminance of an environment on a surface that faces its +z. It counts 2 pi sr for
/// the whole image, half of the sphere's 4 pi, so pictures come out twice as bright as asked; kept to match them.
Float MeasureIlluminance(const LightImage &light) {
    Point2i n = light.image.Resolution();
    Rgb weights = light.colorSpace->Luminance();
    double sum = 0;
    for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) {
            Point2 st((static_cast<Float>(x) + Float(0.5)) / static_cast<Float>(n.x),
                      (static_cast<Float>(y) + Float(0.5)) / static_cast<Float>(n.y));
            Float cosTheta = EqualAreaSquareToSphere(st).z;
            if (cosTheta > 0) sum += static_cast<double>(glm::dot(LightPixel(light.image, {x, y}), weights) * cosTheta);
        }
    return static_cast<Float>(sum * 2 * std::numbers::pi / (static_cast<double>(n.x) * static_cast<double>(n.y)));
}

std::unique_ptr<Light> MakeInfinite(const LightInput &in) {
    const ParamSet &params = in.params;
    SpectrumPtr radiance = GetSpectrum(params, "L", nullptr, SpectrumUse::Illuminant, in.files);
    bool hasImage = !params.GetString("filename", "").empty();
    Float illuminance = params.GetFloat("illuminance", -1);
    params.GetFloat("scale", 1);
    if (params.Find("portal", ParamType::Point3))
        throw UserError(fmt::format("{}: \"portal\" is not supported yet.", params.What()), params.LocOf("portal"));
    if (radiance && hasImage)
        throw UserError(fmt::format("{}: \"L\" and \"filename\" exclude each other.", params.What()),
                        params.LocOf("filename"));
    if (!hasImage) {
        if (!radiance) radiance = in.colorSpace.IlluminantPtr();
        Float scale = PhotometricScale(in, *radiance, "L");
        if (illuminance > 0) scale *= illuminance / Pi;
        return std::make_unique<UniformInfiniteLight>(InternSpectrum(*radiance), scale);
    }

    LightImage light = ReadLightImage(params, "filename", in.files);
    Point2i n = light.image.Resolution();
    if (n.x != n.y)
        throw UserError(
            fmt::format("\"{}\" has {} x {} pixels; an environment must be square, in the equal-area octahedral "
                        "layout (imgtool makeequiarea converts latitude-longitude images).",
                        light.name, n.x, n.y),
            params.LocOf("filename"));
    Float scale = PhotometricScale(in, light.colorSpace->Illuminant(), "filename");
    if (illuminance > 0) {
        Float measured = MeasureIlluminance(light);
        if (!(measured > 0))
            throw UserError(
                fmt::format("\"{}\" is black above the horizon, so \"illuminance\" cannot be reached.", light.name),
                params.LocOf("illuminance"));
        scale *= illuminance / measured;
    }
    return std::make_unique<ImageInfiniteLight>(in.renderFromLight, std::move(light.image), *light.colorSpace, scale);
}

}  // namespace

const std::vector<std::string> &SupportedLights() {
    static const std::vector<std::string> names = {"distant", "infinite", "point", "spot"};
    return names;
}

const std::vector<std::string> &UnsupportedLights() {
    static const std::vector<std::string> names = {"goniometric", "projection"};
    return names;
}

std::unique_ptr<Light> MakeLight(const std::string &type, const ParamSet &params, const Transform &renderFromLight,
                                 const Transform &, const ColorSpace &colorSpace, const FileResolver &files,
                                 DiagnosticSink &) {
    LightInput in{params, renderFromLight, colorSpace, files};
    if (type == "point") return MakePoint(in);
    if (type == "spot") return MakeSpot(in);
    if (type == "distant") return MakeDistant(in);
    if (type == "infinite") return MakeInfinite(in);

    params.MarkAllUsed();
    const std::vector<std::string> &later = UnsupportedLights();
    if (std::find(later.begin(), later.end(), type) != later.end())
        throw UserError(fmt::format("LightSource \"{}\" is not supported yet.", type), params.LocOf(""));
    throw UserError(fmt::format("\"{}\" is not a light source; {}.", type, ListChoices(type, SupportedLights())),
                    params.LocOf(""));
}

struct AreaLightMaker::Impl {
    std::shared_ptr<const AreaEmission> emission;
};

AreaLightMaker::AreaLightMaker(const std::string &type, const ParamSet &params, const ColorSpace &colorSpace,
                               const FileResolver &files, DiagnosticSink &)
    : impl_(std::make_unique<Impl>()) {
    if (type != "diffuse") {
        params.MarkAllUsed();
        throw UserError(fmt::format("\"{}\" is not an area light source; {}.", type, ListChoices(type, {"diffuse"})),
                        params.LocOf(""));
    }
    auto emission = std::make_shared<AreaEmission>();
    LightInput in{params, Transform(), colorSpace, files};
    SpectrumPtr radiance = GetSpectrum(params, "L", nullptr, SpectrumUse::Illuminant, files);
    bool hasImage = !params.GetString("filename", "").empty();
    emission->twoSided = params.GetBool("twosided", false);
    emission->power = params.GetFloat("power", -1);
    params.GetFloat("scale", 1);
    if (radiance && hasImage)
        throw UserError(fmt::format("{}: \"L\" and \"filename\" exclude each other.", params.What()),
                        params.LocOf("filename"));
    if (!radiance) radiance = colorSpace.IlluminantPtr();
    emission->scale = PhotometricScale(in, *radiance, "L");
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

std::unique_ptr<Light> AreaLightMaker::Make(const Shape &shape, uint32_t primitive, const FloatTexture *alpha) const {
    return std::make_unique<DiffuseAreaLight>(impl_->emission, shape, primitive, alpha);
}

}  // namespace pbrt
