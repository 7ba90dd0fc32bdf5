#include "ext/octree/prepass_effort.h"

#include <algorithm>

namespace ext {

namespace {
constexpr double kFewestVertices = 2000, kLargestFactor = 1.75, kMostTries = 4e6;
}  // namespace

double PrepassEffort::Share() const {
    const double renderRays = 2 * pixels * depth * samplesPerPixel;
    const auto tries = static_cast<double>(triesPerVertex);
    const double raysPerVertex = 1 + tries;
    double share = budget;
    if (triesPerVertex >= lights) share = std::max(budget, std::min(kFewestVertices * raysPerVertex / renderRays, kLargestFactor * budget));
    return std::min(share, kMostTries / tries * raysPerVertex / renderRays);
}

double PrepassEffort::PathsPerPixel() const {
    return Share() * 2 * samplesPerPixel / (1 + static_cast<double>(triesPerVertex));
}

}  // namespace ext
