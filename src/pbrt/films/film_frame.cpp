#include "pbrt/films/film_frame.h"

#include <algorithm>
#include <cmath>

#include "pbrt/core/files.h"
#include "pbrt/core/memory.h"
#include "pbrt/images/picture_name.h"

namespace pbrt {

namespace {

std::optional<Bounds2> SceneCropWindow(const ParamSet &params) {
    std::span<const Float> v = params.GetFloats("cropwindow");
    if (v.empty()) return {};
    if (v.size() != 4)
        throw UserError(fmt::format("\"float cropwindow\" takes 4 values (x0 x1 y0 y1), found {}.", v.size()),
                        params.LocOf("cropwindow"));
    return Bounds2{{v[0], v[2]}, {v[1], v[3]}};
}

std::optional<Bounds2i> ScenePixelBounds(const ParamSet &params, int divisor) {
    std::span<const int> v = params.GetInts("pixelbounds");
    if (v.empty()) return {};
    if (v.size() != 4)
        throw UserError(fmt::format("\"integer pixelbounds\" takes 4 values (x0 x1 y0 y1), found {}.", v.size()),
                        params.LocOf("pixelbounds"));
    auto shrink = [&](int i) { return i / divisor; };
    return Bounds2i{{shrink(v[0]), shrink(v[2])}, {shrink(v[1] + divisor - 1), shrink(v[3] + divisor - 1)}};
}

Bounds2i FromCropWindow(const Bounds2 &window, Point2i resolution) {
    auto pixel = [](Float fraction, int extent) {
        return static_cast<int>(std::ceil(static_cast<Float>(extent) * std::clamp(fraction, Float(0), Float(1))));
    };
    Point2 low = glm::min(window.low, window.high), high = glm::max(window.low, window.high);
    return {{pixel(low.x, resolution.x), pixel(low.y, resolution.y)},
            {pixel(high.x, resolution.x), pixel(high.y, resolution.y)}};
}

/// Which pixels are rendered. The command line beats the scene; on either, a crop window beats pixel bounds.
/// Bounds that stick out of the image are cut with a warning; an empty result is an error. Pixel bounds of the scene
/// are meant for the scene's resolution: they shrink with it under --quick.
Bounds2i ChoosePixelBounds(const ParamSet &params, Point2i fullResolution, const FilmOverrides &overrides,
                           DiagnosticSink &sink) {
    std::optional<Bounds2> sceneCrop = SceneCropWindow(params);
    std::optional<Bounds2i> sceneBounds = ScenePixelBounds(params, overrides.resolutionDivisor);
    const Bounds2i full{{0, 0}, fullResolution};
    FileLoc loc = params.LocOf("pixelbounds");

    Bounds2i bounds = full;
    auto take = [&](const Bounds2i &wanted) {
        bounds = Intersect(wanted, full);
        if (!wanted.IsEmpty() && (bounds.low != wanted.low || bounds.high != wanted.high))
            sink.Warning(loc, "The pixel bounds reach beyond the image and are cut.");
    };
    if (overrides.cropWindow) {
        bounds = FromCropWindow(*overrides.cropWindow, fullResolution);
        loc = {};
    } else if (overrides.pixelBounds) {
        loc = {};
        take(*overrides.pixelBounds);
    } else if (sceneCrop) {
        if (sceneBounds)
            sink.Warning(params.LocOf("cropwindow"),
                         "Both a crop window and pixel bounds are given; the crop window counts.");
        bounds = FromCropWindow(*sceneCrop, fullResolution);
        loc = params.LocOf("cropwindow");
    } else if (sceneBounds) {
        take(*sceneBounds);
    }
    if (bounds.IsEmpty())
        throw UserError(
            fmt::format("{}No pixel is left to render: pixel bounds x {} to {}, y {} to {} of {} x {} pixels.",
                        overrides.cropWindow || overrides.pixelBounds ? "command line: " : "", bounds.low.x,
                        bounds.high.x, bounds.low.y, bounds.high.y, fullResolution.x, fullResolution.y),
            loc);
    return bounds;
}

/// Called before the picture is rendered, not after.
void CheckFilename(const std::string &filename, bool onlyExr, const FileLoc &loc) {
    CheckPictureName(filename, loc);
    if (onlyExr && LowerExtension(filename) != ".exr")
        throw UserError(fmt::format("\"{}\": the channels of this film only fit into an .exr file.", filename), loc);
}

int GetExtent(const ParamSet &params, const char *name, int defaultValue, int divisor) {
    return std::max(1, params.GetInt(name, defaultValue, {1, 1 << 20}) / divisor);
}

}  // namespace

FilmFrame ReadFilmFrame(const ParamSet &params, const ColorSpace &outputSpace, const FilmOverrides &overrides,
                        const FrameNeeds &needs, DiagnosticSink &sink) {
    FilmFrame frame;
    frame.outputSpace = &outputSpace;
    frame.fullResolution = {GetExtent(params, "xresolution", 1280, overrides.resolutionDivisor),
                            GetExtent(params, "yresolution", 720, overrides.resolutionDivisor)};
    frame.pixelBounds = ChoosePixelBounds(params, frame.fullResolution, overrides, sink);
    frame.filename = params.GetString("filename", "pbrt.exr");
    if (!overrides.filename.empty()) frame.filename = overrides.filename;
    CheckFilename(frame.filename, needs.onlyExr, overrides.filename.empty() ? params.LocOf("filename") : FileLoc());
    frame.diagonalMm = params.GetFloat("diagonal", 35, Positive(1e6f));
    frame.half = params.GetBool("savefp16", true) && !overrides.fullFloat;
    const Bounds2i &bounds = frame.pixelBounds;
    RequireMemory(static_cast<double>(bounds.Area()) * needs.bytesPerPixel,
                  fmt::format("{}: a picture of {} x {} pixels", params.What(), bounds.Width(), bounds.Height()),
                  params.LocOf("xresolution"));
    return frame;
}

}  // namespace pbrt
