#include "ext/octree/prepass_effort.h"

#include <algorithm>

namespace ext {

namespace {
constexpr double kMinVertices = 2000, kMaxFactor = 1.25, kMaxTries = 4e6;
/// The cost of a drawn try when the tree is built, in units of the cost of a ray.
constexpr double kBuildPerTry = 0.3;
}  // namespace

double PrepassEffort::Share() const {
    const double renderRays = 2 * pixels * depth * samplesPerPixel;
    const auto tries = static_cast<double>(triesPerVertex);
    const double raysPerVertex = RaysPerVertex();
    double share = budget;
    if (!IsDrawn()) share = std::max(budget, std::min(kMinVertices * raysPerVertex / renderRays, kMaxFactor * budget));
    return std::min(share, kMaxTries / tries * raysPerVertex / renderRays);
}

double PrepassEffort::RaysPerVertex() const {
    return 1 + static_cast<double>(skyTries) + static_cast<double>(triesPerVertex) * (IsDrawn() ? 1 + kBuildPerTry : 1);
}

double PrepassEffort::PathsPerPixel() const { return Share() * 2 * samplesPerPixel / RaysPerVertex(); }

}  // namespace ext
