#pragma once
#include "pbrt/films/film.h"
#include "support/given_params.h"

namespace pbrt::test {

inline Params FilmSize(int width, int height) {
    return Params("Film \"rgb\"").Integer("xresolution", width).Integer("yresolution", height);
}

/// A film that rounds nothing to half precision.
inline std::unique_ptr<Film> MakeFullFloat(const std::string &type, const ParamSet &params,
                                           FilmContext context = {.outputSpace = ColorSpace::SRGB()}) {
    DiagnosticSink sink;
    context.overrides.fullFloat = true;
    return MakeFilm(type, params, context, sink);
}

inline Rgb ColorAt(const Film &film, Point2i pixel = {0, 0}) {
    const Image image = film.ToImage();
    return {image.Get(pixel, 0), image.Get(pixel, 1), image.Get(pixel, 2)};
}

}  // namespace pbrt::test
