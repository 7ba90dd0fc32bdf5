#pragma once
#include <array>
#include <limits>

#include "pbrt/core/param_reader.h"
#include "pbrt/films/sensor.h"
#include "pbrt/math/vec.h"

namespace pbrt {

struct FilmParams {
    std::string filename = "pbrt.exr";
    int xResolution = 1280, yResolution = 720;
    std::optional<std::array<Float, 4>> cropWindow;
    std::optional<std::array<int, 4>> pixelBounds;
    Float diagonalMm = 35, maxComponentValue = Infinity;
    bool half = true;
    SensorParams sensor;

    template <class V>
    void Describe(V &&v) {
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

}  // namespace pbrt
