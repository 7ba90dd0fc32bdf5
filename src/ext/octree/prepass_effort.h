#pragma once
#include <cstddef>

namespace ext {

/// How long the prepass of the visibility model is: its rays are the share `budget` of the rays of the render that
/// follows, and take about the same share of its time. Where every vertex tries every light, 1 % lies in the flat
/// minimum of error times time; where tries are drawn among many lights, a short render would gain from a larger budget
/// (measured: docs/measured, "How long a prepass").
struct PrepassEffort {
    size_t lights = 0;          ///< groups to choose from
    size_t triesPerVertex = 0;  ///< shadow rays; if fewer than `lights`, lights are drawn
    size_t skyTries = 0;        ///< more shadow rays, to skies
    int depth = 1;              ///< vertices of a prepass path
    double pixels = 1;
    int samplesPerPixel = 1;  ///< of the render
    double budget = 0.01;     ///< share of the render's rays

    /// The prepass as a share of the render's rays. A vertex costs two rays in the render; in the prepass one and its
    /// tries. Where all lights are tried, which costs less per try, a short render spends up to 1.25 times the budget
    /// to reach 2,000 vertices. No prepass makes more than four million tries.
    double Share() const;
    double PathsPerPixel() const;

  private:
    bool IsDrawn() const { return triesPerVertex < lights; }
    double RaysPerVertex() const;
};

}  // namespace ext
