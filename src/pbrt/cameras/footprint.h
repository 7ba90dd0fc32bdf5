#pragma once
#include <algorithm>

#include "pbrt/math/frame.h"
#include "pbrt/math/ray.h"

namespace pbrt {

/// Smallest steps between neighbouring pixels' rays over the film, in camera space. Directions are relative to a frame
/// with z along the ray.
struct SmallestDifferentials {
    Vector3 positionX{0}, positionY{0};
    Vector3 directionX{0}, directionY{0};
};

/// Searches along the film's diagonal. `generate(Point2 film, Ray *, RayDifferential *)` makes camera-space rays with
/// unit directions for the lens centre; false if there is none.
template <class Generate>
SmallestDifferentials FindSmallestDifferentials(Point2i resolution, const Generate &generate) {
    constexpr int kSteps = 512;
    SmallestDifferentials smallest;
    bool first = true;
    auto keepShorter = [&](Vector3 *shortest, const Vector3 &v) {
        if (first || LengthSquared(v) < LengthSquared(*shortest)) *shortest = v;
    };
    for (int i = 0; i < kSteps; ++i) {
        Float t = static_cast<Float>(i) / (kSteps - 1);
        Ray ray;
        RayDifferential d;
        if (!generate(t * Point2(resolution), &ray, &d)) continue;
        keepShorter(&smallest.positionX, d.rxOrigin - ray.o);
        keepShorter(&smallest.positionY, d.ryOrigin - ray.o);
        Frame frame = Frame::FromZ(ray.d);
        Vector3 along = frame.ToLocal(ray.d);
        keepShorter(&smallest.directionX, Normalize(frame.ToLocal(d.rxDirection)) - along);
        keepShorter(&smallest.directionY, Normalize(frame.ToLocal(d.ryDirection)) - along);
        first = false;
    }
    return smallest;
}

/// Ray spacing of `samplesPerPixel` samples relative to the pixel width, at least 1/8.
inline Float DifferentialScale(int samplesPerPixel) {
    return std::max(Float(0.125), 1 / std::sqrt(static_cast<Float>(samplesPerPixel)));
}

/// Offsets from p to the neighbouring rays' hits with the tangent plane, as if p were straight ahead of the camera.
/// Camera space; zero without such a plane (n = 0 or edge-on).
void FootprintOnTangentPlane(const SmallestDifferentials &smallest, const Point3 &p, const Normal3 &n, Vector3 *dpdx,
                             Vector3 *dpdy);

}  // namespace pbrt
