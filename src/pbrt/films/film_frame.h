#pragma once
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/films/sensor.h"
#include "pbrt/math/bounds.h"

namespace pbrt {

struct FilmParams {
    std::string filename = "pbrt.exr";
    int xResolution = 1280, yResolution = 720;
    std::optional<std::array<Float, 4>> cropWindow;
    std::optional<std::array<int, 4>> pixelBounds;
    Float diagonalMm = 35, maxComponentValue = Infinity;
    bool half = true;
    SensorParams sensor;

    void Describe(auto &&v) {
        v("filename", filename, "image file; --outfile overrides it");
        v("xresolution", xResolution, Range<int>{1, 1 << 20, false, false, "pixels"}, "width");
        v("yresolution", yResolution, Range<int>{1, 1 << 20, false, false, "pixels"}, "height");
        v("cropwindow", cropWindow, "rendered x0 x1 y0 y1 as fractions; overridden by --cropwindow, --pixelbounds");
        v("pixelbounds", pixelBounds, "rendered x0 x1 y0 y1 in pixels; overridden by cropwindow");
        v("diagonal", diagonalMm, Positive(1e6f, "mm"), "film diagonal, for realistic cameras");
        sensor.Describe(v);
        v("maxcomponentvalue", maxComponentValue, Positive(std::numeric_limits<Float>::max()),
          "brighter samples and splats are scaled down to this");
        v("savefp16", half, "write half-precision floats");
    }
};

struct FilmOverrides {
    std::optional<Bounds2> cropWindow;  ///< fractions
    std::optional<Bounds2i> pixelBounds;
    std::string filename;             ///< empty: the scene's
    int resolutionDivisor = 1;        ///< 4 with --quick
    bool fullFloat = false;           ///< float precision regardless of savefp16
    std::vector<std::string> aovs{};  ///< --aov: names of additional channels
};

/// Properties common to all films: size, and output format.
struct FilmFrame {
    Point2i fullResolution{};
    Bounds2i pixelBounds{};  ///< rendered pixels
    std::string filename;
    Float diagonalMm = 35;
    bool half = true;  ///< half-precision output
    const ColorSpace *outputSpace = nullptr;

    size_t PixelCount() const { return pixelBounds.Area(); }
    /// Pixel count of the full image.
    double FullPixels() const { return double(fullResolution.x) * double(fullResolution.y); }
    size_t IndexOf(Point2i pixel) const {
        PBRT_DCHECK(pixelBounds.Contains(pixel));
        const Point2i p = pixel - pixelBounds.low;
        return size_t(p.y) * pixelBounds.Width() + p.x;
    }
};

}  // namespace pbrt
