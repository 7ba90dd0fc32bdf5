#include "ext/octree/prepass_budget.h"

#include <algorithm>

namespace ext {
namespace {
constexpr double kMinVertices = 2000, kMaxFactor = 1.25, kMaxShadowRays = 4e6;
/// Tree build cost of a drawn shadow ray, in units of the cost of a ray.
constexpr double kBuildPerShadowRay = 0.3;
}  // namespace

double PrepassBudget::Share() const {
    const double renderRays = 2 * pixels * depth * samplesPerPixel;
    const auto rays = double(raysPerVertex);
    const double raysPerVertex = RaysPerVertex();
    double share = budget;
    if (!IsDrawn()) share = std::max(budget, std::min(kMinVertices * raysPerVertex / renderRays, kMaxFactor * budget));
    return std::min(share, kMaxShadowRays / rays * raysPerVertex / renderRays);
}

double PrepassBudget::RaysPerVertex() const {
    return 1 + double(environmentRays) + double(raysPerVertex) * (IsDrawn() ? 1 + kBuildPerShadowRay : 1);
}

double PrepassBudget::PathsPerPixel() const { return Share() * 2 * samplesPerPixel / RaysPerVertex(); }

}  // namespace ext
