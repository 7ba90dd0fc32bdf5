#pragma once
#include "pbrt/films/film.h"
#include "pbrt/films/filter.h"

namespace pbrt {

/// Adds a splat at a film position (raster space) to all pixels in the filter's support, with the expected value of
/// filter-sampled pixels.
inline void AddFilteredSplat(Film &film, const Filter &filter, const Point2 &pFilm, const SampledSpectrum &L,
                             const SampledWavelengths &lambda) {
    const Bounds2i &bounds = film.PixelBounds();
    const Point2 first = pFilm - filter.Radius() - Float(0.5), last = pFilm + filter.Radius() - Float(0.5);
    // Compared as floats first: distant positions do not fit into integers.
    if (!(last.x >= Float(bounds.low.x) && last.y >= Float(bounds.low.y) && first.x < Float(bounds.high.x) &&
          first.y < Float(bounds.high.y)))
        return;
    const Point2i low = glm::max(Point2i(glm::ceil(first)), bounds.low),
                  high = glm::min(Point2i(glm::floor(last)), bounds.high - 1);
    const Float perIntegral = 1 / filter.Integral();
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) {
            const Float weight = filter.Evaluate(pFilm - Point2(x, y) - Float(0.5)) * perIntegral;
            if (weight != 0) film.AddSplat({x, y}, L, lambda, weight);
        }
}

}  // namespace pbrt
