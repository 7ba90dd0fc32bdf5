#pragma once
#include <cstddef>

namespace ext {

/// How long the prepass of the visibility model is, by what the render that follows is worth: `budget` of its rays,
/// which takes about as much of its time. Where every vertex tries every light, 1 % lies on the flat bottom of error
/// times time; where tries are drawn among many lights, a short render would gain by more (measured: docs/measured,
/// "How long a prepass").
struct PrepassEffort {
    size_t lights = 0;          ///< groups to choose from
    size_t triesPerVertex = 0;  ///< shadow rays; fewer than `lights`: they are drawn
    int depth = 1;              ///< vertices a path
    double pixels = 1;
    int samplesPerPixel = 1;  ///< of the render
    double budget = 0.01;     ///< share of the render's rays

    /// As a share of the render's rays: two a vertex there; one and its tries in the prepass. Where all lights are
    /// tried, whose rays are the cheaper ones, a short render spends up to 1.25 times the budget for its first 2,000
    /// vertices. None traces more than four million tries.
    double Share() const;
    double PathsPerPixel() const;

  private:
    bool IsDrawn() const { return triesPerVertex < lights; }
    double RaysPerVertex() const;
};

}  // namespace ext
