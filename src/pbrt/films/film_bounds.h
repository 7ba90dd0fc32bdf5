#pragma once
#include "pbrt/films/film.h"

namespace pbrt {

/// Which pixels are rendered. The command line beats the scene; on either, a crop window beats pixel bounds.
/// Bounds that stick out of the image are cut with a warning; an empty result is an error. Pixel bounds of the scene
/// are meant for the scene's resolution: they shrink with it under --quick.
Bounds2i ChoosePixelBounds(const ParamSet &params, Point2i fullResolution, const FilmOverrides &overrides,
                           DiagnosticSink &sink);

}  // namespace pbrt
