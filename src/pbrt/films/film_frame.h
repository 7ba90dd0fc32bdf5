#pragma once
#include <optional>
#include <string>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/films/film_params.h"
#include "pbrt/math/bounds.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

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

    FilmFrame WithFullFloat() const {
        FilmFrame frame = *this;
        frame.half = false;
        return frame;
    }
    size_t PixelCount() const { return static_cast<size_t>(pixelBounds.Area()); }
    /// Pixel count of the full image.
    double FullPixels() const { return double(fullResolution.x) * double(fullResolution.y); }
    size_t IndexOf(Point2i pixel) const {
        PBRT_DCHECK(pixelBounds.Contains(pixel));
        const Point2i p = pixel - pixelBounds.low;
        return static_cast<size_t>(p.y) * static_cast<size_t>(pixelBounds.Width()) + static_cast<size_t>(p.x);
    }
};

struct FrameNeeds {
    bool onlyExr = false;      ///< other formats cannot hold its channels
    double bytesPerPixel = 0;  ///< sums, and the output image
};

/// `set`: source of the parameters. Throws UserError, also if memory is insufficient.
FilmFrame MakeFilmFrame(const FilmParams &params, const ParamSet &set, const ColorSpace &outputSpace,
                        const FilmOverrides &overrides, const FrameNeeds &needs, DiagnosticSink &sink);

}  // namespace pbrt
