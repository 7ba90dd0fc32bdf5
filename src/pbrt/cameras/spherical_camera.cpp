#include "pbrt/cameras/spherical_camera.h"

#include "pbrt/math/warps.h"

namespace pbrt {

SphericalCamera::SphericalCamera(const CameraFrame &frame, SphericalCameraMapping mapping)
    : Camera(frame), mapping_(mapping) {
    FindFootprint();
}

Vector3 SphericalCamera::Direction(const Point2 &film) const {
    Point2 uv = film / Point2(Resolution());
    Vector3 zUp;
    if (mapping_ == SphericalCameraMapping::Equirectangular) {
        Float theta = Pi * uv.y;
        zUp = SphericalDirection(std::sin(theta), std::cos(theta), 2 * Pi * uv.x);
    } else zUp = EqualAreaSquareToSphere(WrapEqualAreaSquare(uv));
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

bool SphericalCamera::ConnectInCameraSpace(const Point3 &p, const Point2 &, CameraConnection *c) const {
    const Float l2 = LengthSquared(p);
    if (!(l2 > 0)) return false;
    c->p = Point3(0);
    const Vector3 d = p / std::sqrt(l2), zUp(d.x, d.z, d.y);
    const Point2 size(Resolution());
    if (mapping_ == SphericalCameraMapping::EqualArea) {
        c->pFilm = EqualAreaSphereToSquare(zUp) * size;
        return true;
    }
    const Float sinTheta = std::sqrt(zUp.x * zUp.x + zUp.y * zUp.y), phi = std::atan2(zUp.y, zUp.x);
    if (!(sinTheta > 0)) return false;
    c->pFilm = Point2((phi < 0 ? phi + 2 * Pi : phi) / (2 * Pi), std::atan2(sinTheta, zUp.z) / Pi) * size;
    return true;
}

Float SphericalCamera::WeightInCameraSpace(const Vector3 &d) const {
    const Float l2 = LengthSquared(d), pixels = Point2(Resolution()).x * Point2(Resolution()).y;
    if (mapping_ == SphericalCameraMapping::EqualArea) return pixels / (4 * Pi * l2);
    // A pixel is Pi / height high, and 2 Pi / width wide on the equator.
    const Float sinTheta = std::sqrt((d.x * d.x + d.z * d.z) / l2);
    return sinTheta > 0 ? pixels / (2 * Pi * Pi * sinTheta * l2) : 0;
}

int SphericalCamera::SeenAlsoAt(const Point2 &pFilm, OtherPlaces &places) const {
    const Point2 size(Resolution());
    const Float x = pFilm.x / size.x, y = pFilm.y / size.y;
    if (mapping_ == SphericalCameraMapping::EqualArea) {
        // Across an edge the square continues with the same edge reversed (WrapEqualAreaSquare).
        places = {Point2(-x, 1 - y), {2 - x, 1 - y}, {1 - x, -y},    {1 - x, 2 - y},
                  {x - 1, y - 1},    {x - 1, y + 1}, {x + 1, y - 1}, {x + 1, y + 1}};
    } else {
        // Beyond a pole the opposite meridian begins.
        const Float other = x < Float(0.5) ? x + Float(0.5) : x - Float(0.5);
        places = {Point2(x - 1, y), {x + 1, y},         {other - 1, -y}, {other, -y},
                  {other + 1, -y},  {other - 1, 2 - y}, {other, 2 - y},  {other + 1, 2 - y}};
    }
    for (Point2 &place : places) place *= size;
    return int(places.size());
}

}  // namespace pbrt
