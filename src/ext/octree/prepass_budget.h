#pragma once
#include <cstddef>

namespace ext {

/// Length of the visibility model's prepass. `budget` is the ratio of prepass rays to render rays, and about the ratio
/// of their times. With shadow rays to all lights, 1 % is within the flat minimum of error times time. With drawn
/// lights, short renders would benefit from a larger budget (docs/results/budget.csv).
struct PrepassBudget {
    size_t lights = 0;           ///< light groups
    size_t raysPerVertex = 0;    ///< shadow rays; if fewer than `lights`, lights are drawn at random
    size_t environmentRays = 0;  ///< additional rays to environment lights
    int depth = 1;               ///< vertices of a prepass path
    double pixels = 1;
    int samplesPerPixel = 1;  ///< of the render
    double budget = 0.01;     ///< fraction of the render's rays

    /// Ratio of prepass rays to render rays. A vertex costs two rays in the render, and one plus its shadow rays in the
    /// prepass. If all lights are tested (cheaper per shadow ray), short renders spend up to 1.25 times the budget to
    /// reach 2,000 vertices. The prepass is limited to four million shadow rays.
    double Share() const;
    double PathsPerPixel() const;

  private:
    bool IsDrawn() const { return raysPerVertex < lights; }
    double RaysPerVertex() const;
};

}  // namespace ext
