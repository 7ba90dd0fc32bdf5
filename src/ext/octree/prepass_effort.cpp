#include "ext/octree/prepass_effort.h"

#include <algorithm>
#include <cmath>

namespace ext {

namespace {
constexpr double kRaysPerLight = 55, kLargestShare = 0.15;
constexpr double kFewestVertices = 2000, kLargestFactor = 3, kMostTries = 4e6;
}  // namespace

double PrepassEffort::Share() const {
    const double vertices = pixels * depth, renderRays = 2 * vertices * samplesPerPixel;
    const auto tries = static_cast<double>(triesPerVertex);
    const double raysPerVertex = 1 + tries;
    double share = std::max(budget, std::min(kFewestVertices * raysPerVertex / renderRays, kLargestFactor * budget));
    if (triesPerVertex < lights) {
        const double best = std::sqrt(kRaysPerLight * static_cast<double>(lights) / renderRays);
        share = std::max(share, std::min(best, kLargestShare));
    }
    return std::min(share, kMostTries / tries * raysPerVertex / renderRays);
}

double PrepassEffort::PathsPerPixel() const {
    return Share() * 2 * samplesPerPixel / (1 + static_cast<double>(triesPerVertex));
}

}  // namespace ext
