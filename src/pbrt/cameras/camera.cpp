#include "pbrt/cameras/camera.h"

#include <algorithm>
#include <limits>

#include "pbrt/cameras/camera_kinds.h"
#include "pbrt/math/frame.h"

namespace pbrt {
namespace {

/// Parameters accepted by every camera, even without effect, as in stock pbrt-v4.
struct CameraParams {
    Float shutterOpen = 0, shutterClose = 1;
    std::optional<Float> frameAspectRatio;
    std::optional<std::array<Float, 4>> screenWindow;

    void Describe(auto &&v) {
        constexpr Range<Float> kShutterRange{-1e9f, 1e9f, false, false, "s"};
        v("shutteropen", shutterOpen, kShutterRange, "shutter opening time");
        v("shutterclose", shutterClose, kShutterRange, "shutter closing time; longer exposures are brighter");
        v("frameaspectratio", frameAspectRatio, Range<Float>{1e-6f, 1e6f},
          "screen width over height; default: the film's");
        v("screenwindow", screenWindow, Range<Float>{-1e9f, 1e9f},
          "xmin xmax ymin ymax; default: shorter side -1 to 1");
    }
    CameraFrame Frame(const ParamSet &set, const CameraContext &context) const {
        if (!(shutterClose > shutterOpen))
            throw set.Error(set.Has("shutterclose") ? "shutterclose" : "shutteropen",
                            "the shutter opens at {} and closes at {}; it must close after it opens.", shutterOpen,
                            shutterClose);
        if (const auto &w = screenWindow; w && ((*w)[0] == (*w)[1] || (*w)[2] == (*w)[3]))
            throw set.Error("screenwindow", "\"screenwindow\" is empty.");
        return {context.renderFromCamera, context.resolution, shutterOpen, shutterClose};
    }
    ScreenWindow Window(Point2i resolution) const {
        if (const auto &w = screenWindow) return {(*w)[0], (*w)[1], (*w)[2], (*w)[3]};
        const Float aspect = frameAspectRatio.value_or(Float(resolution.x) / Float(resolution.y));
        if (aspect > 1) return {-aspect, aspect, -1, 1};
        return {-1, 1, -1 / aspect, 1 / aspect};
    }
};

struct LensParams : CameraParams {
    Lens lens;
    void Describe(auto &&v) {
        CameraParams::Describe(v);
        v("lensradius", lens.radius, Range<Float>{0, 1e15f}, "radius of a thin lens; 0: pinhole");
        v("focaldistance", lens.focalDistance, Positive(std::numeric_limits<Float>::max()),
          "distance to the focal plane");
    }
    CameraFrame Frame(const ParamSet &set, const CameraContext &context) const {
        // With a lens the distance's square must be finite and above 0.
        if (lens.radius > 0) set.Require<Float>("focaldistance", lens.focalDistance, {1e-15f, 1e15f});
        return CameraParams::Frame(set, context);
    }
};

struct PerspectiveParams : LensParams {
    Float fov = 90;
    void Describe(auto &&v) {
        LensParams::Describe(v);
        v("fov", fov, Range<Float>{0, 180, true, true, "degrees"}, "field of view along the shorter side");
    }
};

constexpr NamedValue<SphericalCameraMapping> kMappings[] = {
    {"equalarea", SphericalCameraMapping::EqualArea}, {"equirectangular", SphericalCameraMapping::Equirectangular}};

struct SphericalParams : CameraParams {
    SphericalCameraMapping mapping = SphericalCameraMapping::EqualArea;
    Float lensRadius = 0, focalDistance = 1e30f;
    void Describe(auto &&v) {
        CameraParams::Describe(v);
        v("mapping", mapping, kMappings, "map from directions to the image");
        v("lensradius", lensRadius, "no effect, as in stock");
        v("focaldistance", focalDistance, "no effect, as in stock");
    }
};

struct RealisticParams : CameraParams {
    std::string lensFile, aperture;
    Float diameter = 1, distance = 10;
    void Describe(auto &&v) {
        CameraParams::Describe(v);
        v("lensfile", lensFile, Required(), "lens description");
        v("aperturediameter", diameter, Positive(1e6f, "mm"), "aperture diameter");
        v("focusdistance", distance, kLengthRange, "distance from film to focal plane, in metres");
        v("aperture", aperture, "aperture image or built-in shape; default: disk");
    }
};

std::vector<LensElement> ReadLens(const RealisticParams &p, const ParamSet &set, const CameraContext &context) {
    std::vector<LensElement> elements =
        set.At("lensfile", [&] { return ReadLensFile(context.files.Resolve(p.lensFile)); });
    for (LensElement &e : elements)
        if (e.IsStop()) {
            const Float radius = p.diameter / 2000;
            if (radius > e.apertureRadius)
                set.Warn(context.sink, "aperturediameter",
                         fmt::format("\"aperturediameter\" is {:g} mm; the stop opens to {:g} mm only, which is used.",
                                     p.diameter, e.apertureRadius * 2000));
            e.apertureRadius = std::min(e.apertureRadius, radius);
        }
    if (std::ranges::none_of(elements, &LensElement::IsStop))
        for (const char *name : {"aperturediameter", "aperture"})
            if (set.Has(name))
                set.Warn(context.sink, name, fmt::format("\"{}\" has no effect: the lens has no stop.", name));
    const std::optional<double> thickness = FocusedThickness(elements, double(p.distance));
    if (!thickness)
        throw set.Error("focusdistance", "this lens cannot focus at a distance of {} m from the film.", p.distance);
    elements.back().thickness = Float(*thickness);
    return elements;
}

}  // namespace

std::optional<CameraRay> Camera::GenerateRay(const CameraSample &sample, const SampledWavelengths &) const {
    CameraRay c;
    c.differential.valid = true;
    if (!GenerateInCameraSpace(sample, &c)) return {};
    c.ray.time = Lerp(sample.time, frame_.shutterOpen, frame_.shutterClose);
    const Transform t = frame_.renderFromCamera.At(c.ray.time);
    c.ray.o = t.Point(c.ray.o);
    c.ray.d = Normalize(t.Vector(c.ray.d));
    c.differential.rxOrigin = t.Point(c.differential.rxOrigin);
    c.differential.ryOrigin = t.Point(c.differential.ryOrigin);
    c.differential.rxDirection = Normalize(t.Vector(c.differential.rxDirection));
    c.differential.ryDirection = Normalize(t.Vector(c.differential.ryDirection));
    return c;
}

std::optional<CameraConnection> Camera::Connect(const Point3 &p, const Point2 &uLens, Float time) const {
    const Transform t = frame_.renderFromCamera.At(time);
    // Subtracts first: far from the rendering-space origin the inverse of a point loses precision.
    const Point3 inCamera = t.InverseVector(p - t.Point(Point3(0)));
    CameraConnection c;
    if (!ConnectInCameraSpace(inCamera, uLens, &c)) return {};
    const Vector3 d = inCamera - c.p;
    c.weight = WeightAlong(t, d);
    if (!(c.weight > 0)) return {};
    c.p = t.Point(c.p);
    c.wi = -Normalize(t.Vector(d));
    return c;
}

Float Camera::RayWeight(const Vector3 &d, Float time) const {
    const Transform t = frame_.renderFromCamera.At(time);
    return WeightAlong(t, t.InverseVector(d));
}

/// The weight is an importance by area across the ray: of a lens at a distance, or of a parallel view.
Float Camera::WeightAlong(const Transform &renderFromCamera, const Vector3 &d) const {
    return WeightInCameraSpace(d) * (Length(renderFromCamera.Vector(Normalize(d))) / VolumeScale(renderFromCamera));
}

Float ExposureTime(const ParamSet &params) {
    CameraParams p;
    ParamReader reader(params);
    p.Describe(reader);
    return std::abs(p.shutterClose - p.shutterOpen);
}

const CameraTable &Cameras() {
    static const CameraTable table("Camera", [](CameraTable &t) {
        t.Add<PerspectiveParams>(
            "perspective", "may move, as all cameras", [](const auto &p, const ParamSet &set, auto &c) {
                return std::make_unique<PerspectiveCamera>(p.Frame(set, c), p.Window(c.resolution), p.fov, p.lens);
            });
        t.Add<LensParams>("orthographic", "", [](const auto &p, const ParamSet &set, auto &c) {
            return std::make_unique<OrthographicCamera>(p.Frame(set, c), p.Window(c.resolution), p.lens);
        });
        t.Add<SphericalParams>("spherical", "", [](const auto &p, const ParamSet &set, auto &c) {
            return std::make_unique<SphericalCamera>(p.Frame(set, c), p.mapping);
        });
        t.Add<RealisticParams>("realistic", "**differs** with an aperture image: [departures](#departures)",
                               [](const auto &p, const ParamSet &set, auto &c) {
                                   const CameraFrame frame = p.Frame(set, c);
                                   const ApertureImage aperture =
                                       set.At("aperture", [&] { return ApertureImage::Read(p.aperture, c.files); });
                                   return std::make_unique<RealisticCamera>(frame, c.filmDiagonalMm / 1000,
                                                                            ReadLens(p, set, c), aperture);
                               });
    });
    return table;
}

void Camera::FindFootprint() {
    constexpr int kSteps = 512;  // along the film's diagonal
    bool isFirst = true;
    auto keepShorter = [&](Vector3 &shortest, const Vector3 &v) {
        if (isFirst || LengthSquared(v) < LengthSquared(shortest)) shortest = v;
    };
    for (int i = 0; i < kSteps; ++i) {
        const Float t = Float(i) / (kSteps - 1);
        CameraRay c;
        c.differential.valid = true;
        const CameraSample sample{t * Point2(frame_.resolution), {0.5f, 0.5f}, 0.5f, 1};
        if (!GenerateInCameraSpace(sample, &c) || !c.differential.valid) continue;
        keepShorter(smallest_.positionX, c.differential.rxOrigin - c.ray.o);
        keepShorter(smallest_.positionY, c.differential.ryOrigin - c.ray.o);
        const Frame frame = Frame::FromZ(c.ray.d);
        const Vector3 along = frame.ToLocal(c.ray.d);
        keepShorter(smallest_.directionX, Normalize(frame.ToLocal(c.differential.rxDirection)) - along);
        keepShorter(smallest_.directionY, Normalize(frame.ToLocal(c.differential.ryDirection)) - along);
        isFirst = false;
    }
}

void Camera::ApproximateFootprint(const Point3 &p, const Normal3 &n, Float time, int samplesPerPixel, Vector3 *dpdx,
                                  Vector3 *dpdy) const {
    const Transform t = frame_.renderFromCamera.At(time);
    const Point3 inCamera = t.InversePoint(p);
    const Float distance = Length(inCamera);
    *dpdx = *dpdy = Vector3(0);
    if (!(distance > 0)) return;
    // From near -z, where the smallest rotation to z is not unique, after a half turn about x.
    const bool isBehind = inCamera.z < -0.99f * distance;
    const auto turn = [&](const Vector3 &v) { return isBehind ? Vector3(v.x, -v.y, -v.z) : v; };
    const Vector3 z(0, 0, 1), from = turn(inCamera / distance);
    const Normal3 nz = RotateFromTo(from, z, turn(t.InverseNormal(n)));
    const Float scale = std::max(Float(0.125), 1 / std::sqrt(Float(samplesPerPixel)));
    // To the neighbouring ray's hit with the tangent plane.
    auto step = [&](const Vector3 &origin, const Vector3 &bend) {
        const Vector3 d = z + bend;
        const Float along = (nz.z * distance - Dot(nz, origin)) / Dot(nz, d);
        const bool isHit = std::isfinite(along);
        return t.Vector((isHit ? turn(RotateFromTo(z, from, origin + along * d - distance * z)) : Vector3(0)) * scale);
    };
    *dpdx = step(smallest_.positionX, smallest_.directionX);
    *dpdy = step(smallest_.positionY, smallest_.directionY);
}

}  // namespace pbrt
