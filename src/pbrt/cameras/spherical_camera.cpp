#include "pbrt/cameras/spherical_camera.h"

#include "pbrt/math/warps.h"

namespace pbrt {

SphericalCamera::SphericalCamera(const CameraFrame &frame, SphericalMapping mapping)
    : CameraSpaceCamera(frame), mapping_(mapping) {
    FindFootprint();
}

Vector3 SphericalCamera::Direction(const Point2 &film) const {
    Point2 uv = film / Point2(Resolution());
    Vector3 zUp;
    if (mapping_ == SphericalMapping::Equirectangular) {
        Float theta = Pi * uv.y;
        zUp = SphericalDirection(std::sin(theta), std::cos(theta), 2 * Pi * uv.x);
    } else
        zUp = EqualAreaSquareToSphere(WrapEqualAreaSquare(uv));
    return {zUp.x, zUp.z, zUp.y};
}

bool SphericalCamera::GenerateInCameraSpace(const CameraSample &sample, CameraRay *c) const {
    Ray *ray = &c->ray;
    RayDifferential *d = &c->differential;
    // The mappings are not linear, so one-pixel differentials are extrapolated from a small step.
    constexpr Float kStep = 0.05f;
    auto differential = [&](const Vector2 &step) {
        Vector3 delta = Direction(sample.pFilm + step * kStep) - ray->d;
        return Normalize(ray->d + delta / kStep);
    };
    ray->o = d->rxOrigin = d->ryOrigin = Point3(0);
    ray->d = Direction(sample.pFilm);
    d->rxDirection = differential({1, 0});
    d->ryDirection = differential({0, 1});
    return true;
}

}  // namespace pbrt
