#include "pbrt/films/film_bounds.h"

#include <cmath>

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

}  // namespace

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

}  // namespace pbrt
