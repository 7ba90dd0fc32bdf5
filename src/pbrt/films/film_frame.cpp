#include "pbrt/films/film.h"

#include <algorithm>
#include <cmath>

#include "pbrt/core/files.h"
#include "pbrt/core/memory.h"
#include "pbrt/images/image.h"

namespace pbrt {
namespace {

/// Scales the scene's pixel bounds by 1 / `divisor`, rounded outwards.
Bounds2i Shrunk(const std::array<int, 4> &v, int divisor) {
    auto shrink = [&](int i) { return i / divisor; };
    return Bounds2i{{shrink(v[0]), shrink(v[2])}, {shrink(v[1] + divisor - 1), shrink(v[3] + divisor - 1)}};
}

Bounds2i FromCropWindow(const Bounds2 &window, Point2i resolution) {
    auto pixel = [](Float fraction, int extent) {
        return int(std::ceil(Float(extent) * std::clamp(fraction, Float(0), Float(1))));
    };
    Point2 low = glm::min(window.low, window.high), high = glm::max(window.low, window.high);
    return {{pixel(low.x, resolution.x), pixel(low.y, resolution.y)},
            {pixel(high.x, resolution.x), pixel(high.y, resolution.y)}};
}

/// Rendered pixels. The command line overrides the scene; in both, a crop window overrides pixel bounds. Bounds outside
/// the image are clipped with a warning; an empty result is an error. Pixel bounds of the scene refer to its
/// resolution: they shrink with --quick.
Bounds2i ChoosePixelBounds(const FilmParams &params, const ParamSet &set, Point2i fullResolution,
                           const FilmOverrides &overrides, DiagnosticSink &sink) {
    const Bounds2i full{{0, 0}, fullResolution};
    FileLoc loc = set.LocOf("pixelbounds");

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
    } else if (const auto &v = params.cropWindow) {
        loc = set.LocOf("cropwindow");
        if (params.pixelBounds)
            sink.Warning(loc, "Both a crop window and pixel bounds are given; the crop window counts.");
        bounds = FromCropWindow({{(*v)[0], (*v)[2]}, {(*v)[1], (*v)[3]}}, fullResolution);
    } else if (params.pixelBounds) {
        take(Shrunk(*params.pixelBounds, overrides.resolutionDivisor));
    }
    if (bounds.IsEmpty())
        throw UserError(loc, "{}No pixel is left to render: pixel bounds x {} to {}, y {} to {} of {} x {} pixels.",
                        overrides.cropWindow || overrides.pixelBounds ? "command line: " : "", bounds.low.x,
                        bounds.high.x, bounds.low.y, bounds.high.y, fullResolution.x, fullResolution.y);
    return bounds;
}

}  // namespace

FilmFrame FilmRequest::Frame(const FilmParams &params, const ParamSet &set, bool onlyExr, double bytesPerPixel) const {
    const FilmOverrides &overrides = context.overrides;
    FilmFrame frame;
    frame.outputSpace = &context.outputSpace;
    auto shrunk = [&](int extent) { return std::max(1, extent / overrides.resolutionDivisor); };
    frame.fullResolution = {shrunk(params.xResolution), shrunk(params.yResolution)};
    frame.pixelBounds = ChoosePixelBounds(params, set, frame.fullResolution, overrides, sink);
    frame.filename = overrides.filename.empty() ? params.filename : overrides.filename;
    // Before rendering, so that no render is lost.
    const FileLoc loc = overrides.filename.empty() ? set.LocOf("filename") : FileLoc();
    CheckPictureName(frame.filename, loc);
    if (onlyExr && LowerExtension(frame.filename) != ".exr")
        throw UserError(loc, "\"{}\": the channels of this film only fit into an .exr file.", frame.filename);
    frame.diagonalMm = params.diagonalMm;
    frame.half = params.half && !overrides.fullFloat;
    const Bounds2i &bounds = frame.pixelBounds;
    RequireMemory(double(bounds.Area()) * bytesPerPixel,
                  fmt::format("{}: a picture of {} x {} pixels", set.What(), bounds.Width(), bounds.Height()),
                  set.LocOf("xresolution"));
    return frame;
}

}  // namespace pbrt
