#include "pbrt/cameras/projective_cameras.h"

#include "pbrt/math/warps.h"

namespace pbrt {
namespace {

/// pbrt's screen space to [0, 1]^3 as in stock pbrt-v4's image headers: x and y from [-1, 1] to [0, 1]; z from [0, 1]
/// to [0.5, 1].
Transform NdcFromScreen() { return Transform::Translate(Vector3(0.5f)) * Transform::Scale(Vector3(0.5f)); }

Point3 PointOnLens(const Lens &lens, const Point2 &u) {
    Point2 p = lens.radius * SampleUniformDiskConcentric(u);
    return {p.x, p.y, 0};
}

}  // namespace

PerspectiveCamera::PerspectiveCamera(const CameraFrame &frame, const ScreenWindow &window, Float fovDegrees,
                                     const Lens &lens)
    : Camera(frame), screen_(window, frame.resolution), fovDegrees_(fovDegrees),
      tanHalfFov_(std::tan(Radians(fovDegrees) / 2)), lens_(lens) {
    FindFootprint();
}

std::optional<Transform> PerspectiveCamera::NdcFromCamera() const {
    return NdcFromScreen() * Transform::Perspective(fovDegrees_, 1e-2f, 1000);
}

bool PerspectiveCamera::GenerateInCameraSpace(const CameraSample &sample, CameraRay *c) const {
    Ray *ray = &c->ray;
    RayDifferential *d = &c->differential;
    Point2 screen = screen_(sample.pFilm);
    Vector3 center(screen.x * tanHalfFov_, screen.y * tanHalfFov_, 1);
    Vector3 right = center + Vector3(screen_.StepX() * tanHalfFov_, 0, 0);
    Vector3 below = center + Vector3(0, screen_.StepY() * tanHalfFov_, 0);
    Point3 origin(0);
    if (lens_.radius > 0) {
        // All lens points and the pinhole see the same point of the plane of focus.
        origin = PointOnLens(lens_, sample.pLens);
        center = center * lens_.focalDistance - origin;
        right = right * lens_.focalDistance - origin;
        below = below * lens_.focalDistance - origin;
    }
    ray->o = d->rxOrigin = d->ryOrigin = origin;
    ray->d = Normalize(center);
    d->rxDirection = Normalize(right);
    d->ryDirection = Normalize(below);
    return true;
}

bool PerspectiveCamera::ConnectInCameraSpace(const Point3 &p, const Point2 &uLens, CameraConnection *c) const {
    c->p = lens_.radius > 0 ? PointOnLens(lens_, uLens) : Point3(0);
    const Vector3 d = p - c->p;
    if (!(d.z > 0)) return false;
    // On the plane z = 1, through the ray's point in the plane of focus.
    const Point2 at = lens_.radius > 0 ? (Point2(c->p) + Point2(d) * (lens_.focalDistance / d.z)) / lens_.focalDistance
                                       : Point2(d) / d.z;
    c->pFilm = screen_.Inverse(at / tanHalfFov_);
    return true;
}

Float PerspectiveCamera::WeightInCameraSpace(const Vector3 &d) const {
    if (!(d.z > 0)) return 0;
    // A pixel is an area of the plane z = 1 (of the plane of focus: larger by its squared distance), which subtends
    // cos^3 of it (divided by the same square).
    const Float l2 = LengthSquared(d), cosine = d.z / std::sqrt(l2);
    return 1 / (screen_.PixelArea() * Sqr(tanHalfFov_) * cosine * cosine * cosine * l2);
}

OrthographicCamera::OrthographicCamera(const CameraFrame &frame, const ScreenWindow &window, const Lens &lens)
    : Camera(frame), screen_(window, frame.resolution), lens_(lens) {
    FindFootprint();
}

std::optional<Transform> OrthographicCamera::NdcFromCamera() const {
    return NdcFromScreen() * Transform::Orthographic(0, 1);
}

bool OrthographicCamera::GenerateInCameraSpace(const CameraSample &sample, CameraRay *c) const {
    Ray *ray = &c->ray;
    RayDifferential *d = &c->differential;
    Point3 center(screen_(sample.pFilm), 0);
    Vector3 right(screen_.StepX(), 0, 0), below(0, screen_.StepY(), 0);
    if (lens_.radius > 0) {
        Point3 origin = PointOnLens(lens_, sample.pLens);
        Vector3 toFocus = center + Vector3(0, 0, lens_.focalDistance) - origin;
        ray->o = d->rxOrigin = d->ryOrigin = origin;
        ray->d = Normalize(toFocus);
        d->rxDirection = Normalize(toFocus + right);
        d->ryDirection = Normalize(toFocus + below);
        return true;
    }
    ray->o = center;
    d->rxOrigin = center + right;
    d->ryOrigin = center + below;
    ray->d = d->rxDirection = d->ryDirection = {0, 0, 1};
    return true;
}

bool OrthographicCamera::ConnectInCameraSpace(const Point3 &p, const Point2 &uLens, CameraConnection *c) const {
    if (!(lens_.radius > 0)) {
        if (!(p.z > 0)) return false;
        c->p = {p.x, p.y, 0};
        c->pFilm = screen_.Inverse(Point2(p));
        return true;
    }
    c->p = PointOnLens(lens_, uLens);
    const Vector3 d = p - c->p;
    if (!(d.z > 0)) return false;
    c->pFilm = screen_.Inverse(Point2(c->p) + Point2(d) * (lens_.focalDistance / d.z));
    return true;
}

Float OrthographicCamera::WeightInCameraSpace(const Vector3 &d) const {
    if (IsParallel()) return 1 / screen_.PixelArea();
    if (!(d.z > 0)) return 0;
    const Float l2 = LengthSquared(d), cosine = d.z / std::sqrt(l2);
    return Sqr(lens_.focalDistance) / (screen_.PixelArea() * cosine * cosine * cosine * l2);
}

}  // namespace pbrt
