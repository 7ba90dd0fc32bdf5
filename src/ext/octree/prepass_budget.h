#pragma once
#include <cstddef>

namespace ext {

/// The length of the prepass of the visibility model: its rays are the share `budget` of the rays of the render that
/// follows, and take about the same share of its time. Where shadow rays go to every light, 1 % lies in the flat
/// minimum of error times time; where lights are drawn among many, a short render would gain from a larger budget
/// (docs/results/budget.csv).
struct PrepassBudget {
    size_t lights = 0;           ///< groups to choose from
    size_t raysPerVertex = 0;    ///< shadow rays; if fewer than `lights`, lights are drawn
    size_t environmentRays = 0;  ///< more rays, to environment lights
    int depth = 1;               ///< vertices of a prepass path
    double pixels = 1;
    int samplesPerPixel = 1;  ///< of the render
    double budget = 0.01;     ///< share of the render's rays

    /// The prepass as a share of the render's rays. A vertex costs two rays in the render; in the prepass one and its
    /// shadow rays. Without drawing, which costs less per shadow ray, a short render spends up to 1.25 times the budget
    /// to reach 2,000 vertices. No prepass makes more than four million shadow rays.
    double Share() const;
    double PathsPerPixel() const;

  private:
    bool IsDrawn() const { return raysPerVertex < lights; }
    double RaysPerVertex() const;
};

}  // namespace ext
