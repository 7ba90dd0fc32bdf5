#pragma once
#include <algorithm>
#include <cstddef>

namespace ext {

/// Length of the visibility model's prepass. `budget` is the ratio of prepass rays to render rays, and about the ratio
/// of their times. With shadow rays to all lights, 1 % is within the flat minimum of error times time. With drawn
/// lights, short renders would benefit from a larger budget.
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
    double Share() const {
        constexpr double kMinVertices = 2000, kMaxFactor = 1.25, kMaxShadowRays = 4e6;
        const double renderRays = 2 * pixels * depth * samplesPerPixel, perVertex = RaysPerVertex();
        double share = budget;
        if (!IsDrawn()) share = std::max(budget, std::min(kMinVertices * perVertex / renderRays, kMaxFactor * budget));
        return std::min(share, kMaxShadowRays / double(raysPerVertex) * perVertex / renderRays);
    }
    double PathsPerPixel() const { return Share() * 2 * samplesPerPixel / RaysPerVertex(); }

  private:
    /// Tree build cost of a drawn shadow ray, in units of the cost of a ray.
    static constexpr double kBuildPerShadowRay = 0.3;
    bool IsDrawn() const { return raysPerVertex < lights; }
    double RaysPerVertex() const {
        return 1 + double(environmentRays) + double(raysPerVertex) * (IsDrawn() ? 1 + kBuildPerShadowRay : 1);
    }
};

}  // namespace ext
