#include "pbrt/cameras/camera.h"

#include <algorithm>

#include "pbrt/cameras/projective_cameras.h"
#include "pbrt/cameras/spherical_camera.h"

namespace pbrt {

const std::vector<std::string> &SupportedCameras() {
    static const std::vector<std::string> names = {"perspective", "orthographic", "spherical"};
    return names;
}

const std::vector<std::string> &UnsupportedCameras() {
    static const std::vector<std::string> names = {"realistic"};
    return names;
}

namespace {

[[noreturn]] void Complain(const ParamSet &params, const char *name, Float value, const char *rule) {
    throw UserError(fmt::format("{}: \"{}\" is {}; {}.", params.What(), name, value, rule), params.LocOf(name));
}

CameraFrame ReadFrame(const ParamSet &params, const Transform &renderFromCamera, Point2i resolution,
                      DiagnosticSink &sink) {
    CameraFrame frame;
    frame.renderFromCamera = renderFromCamera;
    frame.resolution = resolution;
    frame.shutterOpen = params.GetFloat("shutteropen", 0);
    frame.shutterClose = params.GetFloat("shutterclose", 1);
    if (frame.shutterClose < frame.shutterOpen) {
        sink.Warning(params.LocOf("shutterclose"),
                     fmt::format("{}: the shutter closes ({}) before it opens ({}): exchanged.", params.What(),
                                 frame.shutterClose, frame.shutterOpen));
        std::swap(frame.shutterClose, frame.shutterOpen);
    }
    if (!(frame.shutterClose > frame.shutterOpen))
        Complain(params, "shutterclose", frame.shutterClose,
                 "the exposure time, shutterclose - shutteropen, must be above 0");
    return frame;
}

ScreenWindow ReadScreenWindow(const ParamSet &params, Point2i resolution) {
    Float aspect =
        params.GetFloat("frameaspectratio", static_cast<Float>(resolution.x) / static_cast<Float>(resolution.y));
    if (!(aspect > 0)) Complain(params, "frameaspectratio", aspect, "it must be above 0");
    std::span<const Float> given = params.GetFloats("screenwindow");
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
    lens.radius = params.GetFloat("lensradius", lens.radius);
    lens.focalDistance = params.GetFloat("focaldistance", lens.focalDistance);
    if (!(lens.radius >= 0)) Complain(params, "lensradius", lens.radius, "it must not be negative");
    if (!(lens.focalDistance > 0)) Complain(params, "focaldistance", lens.focalDistance, "it must be above 0");
    return lens;
}

Float ReadFov(const ParamSet &params) {
    Float fov = params.GetFloat("fov", 90);
    if (!(fov > 0 && fov < 180)) Complain(params, "fov", fov, "it must lie between 0 and 180 degrees");
    return fov;
}

std::unique_ptr<Camera> MakeSpherical(const ParamSet &params, const CameraFrame &frame, Point2i resolution) {
    // Taken for the sake of a common parameter list; without meaning here, as in stock pbrt-v4.
    params.GetFloat("lensradius", 0);
    params.GetFloat("focaldistance", 1e30f);
    ReadScreenWindow(params, resolution);
    std::string mapping = params.GetChoice("mapping", "equalarea", {"equalarea", "equirectangular"});
    return std::make_unique<SphericalCamera>(
        frame, mapping == "equalarea" ? SphericalMapping::EqualArea : SphericalMapping::Equirectangular);
}

}  // namespace

std::unique_ptr<Camera> MakeCamera(const std::string &type, const ParamSet &params, const Transform &renderFromCamera,
                                   Point2i resolution, DiagnosticSink &sink) {
    auto isIn = [&](const std::vector<std::string> &names) {
        return std::find(names.begin(), names.end(), type) != names.end();
    };
    if (!isIn(SupportedCameras())) {
        bool known = isIn(UnsupportedCameras());
        throw UserError(fmt::format("Camera \"{}\" is {}; {}.", type, known ? "not supported yet" : "unknown",
                                    ListChoices(known ? "" : type, SupportedCameras())),
                        params.Loc());
    }
    std::unique_ptr<Camera> camera;
    CameraFrame frame = ReadFrame(params, renderFromCamera, resolution, sink);
    if (type == "perspective") {
        ScreenWindow window = ReadScreenWindow(params, resolution);
        Lens lens = ReadLens(params);
        camera = std::make_unique<PerspectiveCamera>(frame, window, ReadFov(params), lens);
    } else if (type == "orthographic") {
        ScreenWindow window = ReadScreenWindow(params, resolution);
        camera = std::make_unique<OrthographicCamera>(frame, window, ReadLens(params));
    } else
        camera = MakeSpherical(params, frame, resolution);
    params.ReportUnused(sink);
    return camera;
}

}  // namespace pbrt
