#pragma once
#include <cstddef>

namespace ext {

/// How long the prepass of the visibility model is, by what the render that follows is worth.
///
/// Of a render of N rays, a share b spent on looking for light leaves an error of about (1 + K / (b N)) times the least
/// possible one, in a time of 1 + b: least at b = sqrt(K / N). K is how many rays it takes to know the scene's lights. Where
/// every vertex tries every light it is so small that `budget` lies on the flat bottom; where tries are drawn, K = 55
/// rays a light (measured with 200 and 1,000 lights, docs/measured). So short renders of many lights spend more, at most 15 %.
struct PrepassEffort {
    size_t lights = 0;           ///< groups to choose from
    size_t triesPerVertex = 0;   ///< shadow rays; fewer than `lights`: they are drawn
    int depth = 1;               ///< vertices a path
    double pixels = 1;
    int samplesPerPixel = 1;     ///< of the render
    double budget = 0.01;        ///< share of the render's rays that a long render spends

    /// As a share of the render's rays: two a vertex there; one and its tries in the prepass. Any render spends up to three
    /// times the budget for its first 2,000 vertices; none traces more than four million tries.
    double Share() const;
    double PathsPerPixel() const;
};

}  // namespace ext
