#pragma once
#include <optional>
#include <string>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/films/film_params.h"
#include "pbrt/math/bounds.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

/// Command line settings that override the scene's film parameters.
struct FilmOverrides {
    std::optional<Bounds2> cropWindow;  ///< fractions
    std::optional<Bounds2i> pixelBounds;
    std::string filename;             ///< empty: the scene's
    int resolutionDivisor = 1;        ///< 4 with --quick
    bool fullFloat = false;           ///< float precision whatever the value of savefp16
    std::vector<std::string> aovs{};  ///< --aov: names of AovNames, whose channels are added to the film
};

/// What all films have in common: the size, and how the picture is written.
struct FilmFrame {
    Point2i fullResolution{};
    Bounds2i pixelBounds{};  ///< the pixels that are rendered
    std::string filename;
    Float diagonalMm = 35;
    bool half = true;  ///< the picture has half precision
    const ColorSpace *outputSpace = nullptr;

    FilmFrame WithFullFloat() const {
        FilmFrame frame = *this;
        frame.half = false;
        return frame;
    }
    size_t PixelCount() const { return static_cast<size_t>(pixelBounds.Area()); }
    /// The number of pixels of the whole picture.
    double FullPixels() const { return double(fullResolution.x) * double(fullResolution.y); }
    size_t IndexOf(Point2i pixel) const {
        PBRT_DCHECK(pixelBounds.Contains(pixel));
        const Point2i p = pixel - pixelBounds.low;
        return static_cast<size_t>(p.y) * static_cast<size_t>(pixelBounds.Width()) + static_cast<size_t>(p.x);
    }
};

/// What a film of one kind needs of its frame.
struct FrameNeeds {
    bool onlyExr = false;      ///< no other format can hold its channels
    double bytesPerPixel = 0;  ///< of the sums, and of the picture that is made of them for writing
};

/// `set`: what the parameters were read from. Throws UserError, also if the machine has not enough memory.
FilmFrame MakeFilmFrame(const FilmParams &params, const ParamSet &set, const ColorSpace &outputSpace,
                        const FilmOverrides &overrides, const FrameNeeds &needs, DiagnosticSink &sink);

}  // namespace pbrt
