#include "pbrt/cameras/camera.h"

#include <algorithm>
#include <limits>

#include "pbrt/cameras/projective_cameras.h"
#include "pbrt/cameras/realistic_camera.h"
#include "pbrt/cameras/spherical_camera.h"
#include "pbrt/core/limits.h"

namespace pbrt {

const std::vector<std::string> &SupportedCameras() {
    static const std::vector<std::string> names = {"perspective", "orthographic", "spherical", "realistic"};
    return names;
}

namespace {

/// Of times in seconds; a picture's brightness goes with their difference.
constexpr Range<Float> kShutterRange{-1e9f, 1e9f};

CameraFrame ReadFrame(const ParamSet &params, const AnimatedTransform &renderFromCamera, Point2i resolution) {
    CameraFrame frame;
    frame.renderFromCamera = renderFromCamera;
    frame.resolution = resolution;
    frame.shutterOpen = params.GetFloat("shutteropen", 0, kShutterRange);
    frame.shutterClose = params.GetFloat("shutterclose", 1, kShutterRange);
    if (!(frame.shutterClose > frame.shutterOpen))
        throw UserError(fmt::format("{}: the shutter opens at {} and closes at {}; it must close after it opens.",
                                    params.What(), frame.shutterOpen, frame.shutterClose),
                        params.LocOf(params.Has("shutterclose") ? "shutterclose" : "shutteropen"));
    return frame;
}

ScreenWindow ReadScreenWindow(const ParamSet &params, Point2i resolution) {
    Float aspect = params.GetFloat("frameaspectratio",
                                   static_cast<Float>(resolution.x) / static_cast<Float>(resolution.y), {1e-6f, 1e6f});
    std::span<const Float> given = params.GetFloats("screenwindow");
    for (Float edge : given) params.Require<Float>("screenwindow", edge, {-1e9f, 1e9f});
    if (given.empty()) {
        if (aspect > 1) return {-aspect, aspect, -1, 1};
        return {-1, 1, -1 / aspect, 1 / aspect};
    }
    if (given.size() != 4)
        throw UserError(fmt::format("{}: \"screenwindow\" takes four values (xmin xmax ymin ymax), found {}.",
                                    params.What(), given.size()),
                        params.LocOf("screenwindow"));
    if (given[0] == given[1] || given[2] == given[3])
        throw UserError(fmt::format("{}: \"screenwindow\" is empty.", params.What()), params.LocOf("screenwindow"));
    return {given[0], given[1], given[2], given[3]};
}

Lens ReadLens(const ParamSet &params) {
    Lens lens;
    lens.radius = params.GetFloat("lensradius", lens.radius, {0, 1e15f});
    lens.focalDistance =
        params.GetFloat("focaldistance", lens.focalDistance, Positive(std::numeric_limits<Float>::max()));
    // Where it counts, the distance is squared.
    if (lens.radius > 0) params.Require<Float>("focaldistance", lens.focalDistance, {1e-15f, 1e15f});
    return lens;
}

Float ReadFov(const ParamSet &params) { return params.GetFloat("fov", 90, {0, 180, true, true}); }

std::unique_ptr<Camera> MakeSpherical(const ParamSet &params, const CameraFrame &frame, Point2i resolution) {
    // Taken for the sake of a common parameter list; without meaning here, as in stock pbrt-v4.
    params.GetFloat("lensradius", 0);
    params.GetFloat("focaldistance", 1e30f);
    ReadScreenWindow(params, resolution);
    std::string mapping = params.GetChoice("mapping", "equalarea", {"equalarea", "equirectangular"});
    return std::make_unique<SphericalCamera>(
        frame, mapping == "equalarea" ? SphericalMapping::EqualArea : SphericalMapping::Equirectangular);
}

/// The lens with the stop's diameter and the focus that the parameters ask for.
std::vector<LensElement> ReadLensElements(const ParamSet &params, const FileResolver &files, DiagnosticSink &sink) {
    const std::string name = params.GetString("lensfile", "");
    const Float diameter = params.GetFloat("aperturediameter", 1, Positive(1e6f));
    const Float distance = params.GetFloat("focusdistance", 10, kLengthRange);
    if (name.empty())
        throw UserError(fmt::format("{}: \"lensfile\" is missing: the description of the lens.", params.What()),
                        params.LocOf("lensfile"));
    std::vector<LensElement> elements;
    try {
        elements = ReadLensFile(files.Resolve(name));
    } catch (const UserError &e) {
        throw UserError(e.Diagnostics().front().message, params.LocOf("lensfile"));
    }
    for (LensElement &e : elements)
        if (e.IsStop()) {
            const Float radius = diameter / 2000;
            if (radius > e.apertureRadius)
                sink.Warning(params.LocOf("aperturediameter"),
                             fmt::format("{}: \"aperturediameter\" is {} mm, but the stop opens to {} mm only: that is "
                                         "used.",
                                         params.What(), diameter, e.apertureRadius * 2000));
            e.apertureRadius = std::min(e.apertureRadius, radius);
        }
    const std::optional<double> thickness = FocusedThickness(elements, double(distance));
    if (!thickness)
        throw UserError(fmt::format("{}: this lens cannot focus on a distance of {} m from the film.", params.What(),
                                    distance),
                        params.LocOf("focusdistance"));
    elements.back().thickness = static_cast<Float>(*thickness);
    return elements;
}

std::unique_ptr<Camera> MakeRealistic(const ParamSet &params, const CameraFrame &frame, Float filmDiagonalMm,
                                      const FileResolver &files, DiagnosticSink &sink) {
    ReadScreenWindow(params, frame.resolution);  // taken, without meaning
    const ApertureImage aperture = ApertureImage::Read(params, "aperture", files);
    return std::make_unique<RealisticCamera>(frame, filmDiagonalMm / 1000, ReadLensElements(params, files, sink),
                                             aperture);
}

}  // namespace

std::unique_ptr<Camera> MakeCamera(const std::string &type, const ParamSet &params,
                                   const AnimatedTransform &renderFromCamera, const FilmFormat &film,
                                   const FileResolver &files, DiagnosticSink &sink) {
    if (std::find(SupportedCameras().begin(), SupportedCameras().end(), type) == SupportedCameras().end())
        throw UserError(fmt::format("Camera \"{}\" is unknown; {}.", type, ListChoices(type, SupportedCameras())),
                        params.Loc());
    const Point2i resolution = film.resolution;
    std::unique_ptr<Camera> camera;
    CameraFrame frame = ReadFrame(params, renderFromCamera, resolution);
    if (type == "perspective") {
        ScreenWindow window = ReadScreenWindow(params, resolution);
        Lens lens = ReadLens(params);
        camera = std::make_unique<PerspectiveCamera>(frame, window, ReadFov(params), lens);
    } else if (type == "orthographic") {
        ScreenWindow window = ReadScreenWindow(params, resolution);
        camera = std::make_unique<OrthographicCamera>(frame, window, ReadLens(params));
    } else if (type == "realistic") {
        camera = MakeRealistic(params, frame, film.diagonalMm, files, sink);
    } else
        camera = MakeSpherical(params, frame, resolution);
    params.ReportUnused(sink);
    return camera;
}

}  // namespace pbrt
