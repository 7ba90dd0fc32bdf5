#include "pbrt/cameras/lens_system.h"

#include "pbrt/core/error.h"

namespace pbrt {

LensSystem::LensSystem(std::span<const LensElement> elements, const ApertureImage &aperture) : aperture_(aperture) {
    PBRT_CHECK(!elements.empty());
    double z = 0;
    for (size_t i = elements.size(); i-- > 0;) {
        const LensElement &e = elements[i];
        z += double(e.thickness);
        const Float indexInFront = i > 0 ? elements[i - 1].index : 1;
        surfaces_.push_back(
            {e.IsStop() ? 0 : 1 / e.curvatureRadius, static_cast<Float>(z), e.apertureRadius, e.index / indexInFront});
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
