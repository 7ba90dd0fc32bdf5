#include "pbrt/cameras/lens_system.h"

#include <cmath>

#include "pbrt/core/files.h"

namespace pbrt {

std::vector<LensElement> ReadLensFile(const std::string &path) {
    const std::vector<Float> v = ReadNumberFile(path);
    if (v.empty() || v.size() % 4 != 0)
        throw UserError(
            "{}: a lens file holds four numbers per element (curvature radius, thickness, "
            "index of refraction, aperture diameter); found {} numbers.",
            path, v.size());
    std::vector<LensElement> elements;
    for (size_t i = 0; i < v.size(); i += 4) {
        constexpr Float kMillimetre = 0.001f;
        LensElement e{v[i] * kMillimetre, v[i + 1] * kMillimetre, v[i + 2], v[i + 3] / 2 * kMillimetre};
        auto complain = [&](const char *what, Float value) {
            throw UserError("{}: element {}: the {} is {}.", path, i / 4 + 1, what, value);
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

Traced TraceParallelRay(std::span<const LensElement> elements, bool isFromScene) {
    double y = 1, u = 0;
    for (size_t k = 0; k < elements.size(); ++k) {
        const size_t i = isFromScene ? k : elements.size() - 1 - k;
        const LensElement &e = elements[i];
        // Along the light; radius above 0: convex towards it.
        double radius = double(e.curvatureRadius), before = i > 0 ? double(elements[i - 1].index) : 1,
               after = double(e.index), thickness = double(e.thickness);
        if (!isFromScene) {
            radius = -radius;
            std::swap(before, after);
            thickness = i > 0 ? double(elements[i - 1].thickness) : 0;
        }
        if (radius != 0) u = (before * u - y * (after - before) / radius) / after;
        if (k + 1 < elements.size()) y += thickness * u;
    }
    return {y, u};
}

}  // namespace

CardinalPoints ComputeCardinalPoints(std::span<const LensElement> elements) {
    const Traced behind = TraceParallelRay(elements, true), before = TraceParallelRay(elements, false);
    // The outgoing ray, extended back, has its initial height at the principal plane; the focal point lies a focal
    // length behind it.
    return {.focalLength = -1 / behind.slope,
            .rearPrincipal = (behind.height - 1) / behind.slope,
            .frontPrincipal = (before.height - 1) / before.slope};
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

LensSystem::LensSystem(std::span<const LensElement> elements, const ApertureImage &aperture) : aperture_(aperture) {
    PBRT_CHECK(!elements.empty());
    double z = 0;
    for (size_t i = elements.size(); i-- > 0;) {
        const LensElement &e = elements[i];
        z += double(e.thickness);
        const Float indexInFront = i > 0 ? elements[i - 1].index : 1;
        surfaces_.push_back(
            {e.IsStop() ? 0 : 1 / e.curvatureRadius, Float(z), e.apertureRadius, e.index / indexInFront});
    }
}

Float LensSystem::Trace(Ray *ray) const {
    Float weight = 1;
    Point3 p = ray->o;
    Vector3 d = ray->d;
    for (const Surface &s : surfaces_) {
        p.z -= s.z;
        const bool isStop = s.curvature == 0;
        // Surface relative to its vertex: c |p|^2 + 2 z = 0. Along the ray c t^2 + 2 b t + a = 0; the root on this side
        // of the sphere has cosine sqrt(b^2 - c a) with the normal.
        const Float a = s.curvature * LengthSquared(p) + 2 * p.z, b = s.curvature * Dot(p, d) + d.z;
        const Float cosine2 = b * b - s.curvature * a;
        if (!(cosine2 > 0)) return 0;
        const Float cosine = std::sqrt(cosine2);
        const Float t = b >= 0 ? -a / (b + cosine) : (cosine - b) / s.curvature;
        if (!(t >= 0)) return 0;
        p += d * t;
        if (isStop) {
            if (aperture_) {
                weight *= aperture_.Lookup({p.x / s.apertureRadius, p.y / s.apertureRadius});
                if (weight == 0) return 0;
            } else if (Sqr(p.x) + Sqr(p.y) > Sqr(s.apertureRadius)) return 0;
        } else {
            if (Sqr(p.x) + Sqr(p.y) > Sqr(s.apertureRadius)) return 0;
            const Vector3 n(s.curvature * p.x, s.curvature * p.y, s.curvature * p.z + 1);
            const Float refracted2 = 1 - Sqr(s.relativeIndex) * (1 - cosine2);
            if (!(refracted2 > 0)) return 0;
            d = d * s.relativeIndex + n * (std::sqrt(refracted2) - s.relativeIndex * cosine);
        }
        p.z += s.z;
    }
    ray->o = p;
    ray->d = Normalize(d);
    return weight;
}

}  // namespace pbrt
