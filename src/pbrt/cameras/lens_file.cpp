#include "pbrt/cameras/lens_file.h"

#include <algorithm>
#include <cmath>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"

namespace pbrt {

std::vector<LensElement> ReadLensFile(const std::string &path) {
    const std::vector<Float> v = ReadNumberFile(path);
    if (v.empty() || v.size() % 4 != 0)
        throw UserError(
            fmt::format("{}: a lens file holds four numbers per element (curvature radius, thickness, "
                        "index of refraction, aperture diameter); found {} numbers.",
                        path, v.size()));
    std::vector<LensElement> elements;
    for (size_t i = 0; i < v.size(); i += 4) {
        constexpr Float kMillimetre = 0.001f;
        LensElement e{v[i] * kMillimetre, v[i + 1] * kMillimetre, v[i + 2], v[i + 3] / 2 * kMillimetre};
        auto complain = [&](const char *what, Float value) {
            throw UserError(fmt::format("{}: element {}: the {} is {}.", path, i / 4 + 1, what, value));
        };
        if (!(e.thickness >= 0)) complain("thickness", v[i + 1]);
        if (e.IsStop() && e.index == 0) e.index = 1;
        if (!(e.index > 0)) complain("index of refraction", e.index);
        if (!(e.apertureRadius > 0)) complain("aperture diameter", v[i + 3]);
        elements.push_back(e);
    }
    return elements;
}

namespace {

/// Paraxial ray entering parallel to the axis at height 1: height and slope behind the lens.
struct Traced {
    double height, slope;
};

/// Surface in the order of light. Radius above 0: convex towards the light; 0: not refracting.
struct ParaxialSurface {
    double radius, indexBefore, indexAfter, thickness;
};

Traced TraceParallelRay(const std::vector<ParaxialSurface> &surfaces) {
    double y = 1, u = 0;
    for (size_t i = 0; i < surfaces.size(); ++i) {
        const ParaxialSurface &s = surfaces[i];
        if (s.radius != 0) u = (s.indexBefore * u - y * (s.indexAfter - s.indexBefore) / s.radius) / s.indexAfter;
        if (i + 1 < surfaces.size()) y += s.thickness * u;
    }
    return {y, u};
}

}  // namespace

CardinalPoints ComputeCardinalPoints(std::span<const LensElement> elements) {
    std::vector<ParaxialSurface> fromScene, fromFilm;
    const size_t n = elements.size();
    for (size_t i = 0; i < n; ++i) {
        const double before = i > 0 ? double(elements[i - 1].index) : 1, after = double(elements[i].index);
        const double radius = double(elements[i].curvatureRadius);
        fromScene.push_back({radius, before, after, double(elements[i].thickness)});
        fromFilm.push_back({-radius, after, before, i > 0 ? double(elements[i - 1].thickness) : 0});
    }
    std::reverse(fromFilm.begin(), fromFilm.end());
    const Traced behind = TraceParallelRay(fromScene), before = TraceParallelRay(fromFilm);
    // The outgoing ray, extended back, has its initial height at the principal plane; the focal point lies a focal
    // length behind it.
    CardinalPoints points;
    points.focalLength = -1 / behind.slope;
    points.rearPrincipal = (behind.height - 1) / behind.slope;
    points.frontPrincipal = (before.height - 1) / before.slope;
    return points;
}

std::optional<double> FocusedThickness(std::span<const LensElement> elements, double distance) {
    const CardinalPoints p = ComputeCardinalPoints(elements);
    if (!(p.focalLength > 0) || !std::isfinite(p.focalLength)) return {};
    double length = 0;
    for (size_t i = 0; i + 1 < elements.size(); ++i) length += double(elements[i].thickness);
    // Film and scene distances s and t from the principal planes: 1/s + 1/t = 1/f, s + t = the rest of `distance`. Of
    // two solutions, takes the film closer to the focal point.
    const double sum = distance - (length - p.frontPrincipal - p.rearPrincipal);
    const double root = sum * (sum - 4 * p.focalLength);
    if (!(sum > 0) || !(root >= 0)) return {};
    const double thickness = (sum - std::sqrt(root)) / 2 - p.rearPrincipal;
    if (!(thickness > 0)) return {};
    return thickness;
}

}  // namespace pbrt
