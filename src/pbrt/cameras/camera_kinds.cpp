#include "pbrt/cameras/camera_kinds.h"

#include <algorithm>
#include <array>

#include "pbrt/core/parallel.h"
#include "pbrt/math/warps.h"

namespace pbrt {
namespace {

/// Screen space to [0, 1]^3 as in stock's image headers: x and y from [-1, 1] to [0, 1]; z from [0, 1] to [0.5, 1].
Transform NdcFromScreen() { return Transform::Translate(Vector3(0.5f)) * Transform::Scale(Vector3(0.5f)); }

Point3 PointOnLens(const Lens &lens, const Point2 &u) {
    Point2 p = lens.radius * SampleUniformDiskConcentric(u);
    return {p.x, p.y, 0};
}

constexpr int kSteps = 64;  // as in stock pbrt-v4, so that the same fraction of samples hits the pupil

bool IsEmpty(const Bounds2 &b) { return !(b.low.x <= b.high.x); }

Bounds2 Grow(const Bounds2 &b, const Vector2 &by) { return {b.low - by, b.high + by}; }

/// Finds the pupil of film points between two distances from the axis. Symmetric in y.
class Search {
  public:
    Search(const LensSystem &lens, Float low, Float high)
        : lens_(lens), film_{low, (low + high) / 2, high}, rear_(Float(1.5) * lens.RearRadius()) {}

    Bounds2 Find() {
        const Bounds2 whole{Point2(-rear_), Point2(rear_)};
        // Refines, because a coarse grid may miss a small stop.
        for (int n = 32; IsEmpty(found_) && n <= 512; n *= 2) Cover(whole, n);
        // Without a pupil the whole rear element is sampled, as in stock pbrt-v4; so missing a tiny pupil is harmless.
        if (IsEmpty(found_)) return whole;
        // The pupil extends little more than a grid step beyond the outermost hits.
        for (int n : {48, 96, 192}) Cover(Grow(found_, Float(1.5) * step_), n);
        return Grow(found_, Float(1.5) * step_);
    }

  private:
    void Cover(const Bounds2 &area, int n) {
        const Vector2 step((area.high.x - area.low.x) / Float(n), area.high.y / Float(n));
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const Point2 p = Point2(area.low.x, 0) + (Point2(i, j) + Point2(0.5f)) * step;
                if (p.x >= found_.low.x && p.x <= found_.high.x && p.y <= found_.high.y) continue;
                if (!Passes(p)) continue;
                found_.low = glm::min(found_.low, Point2(p.x, -p.y));
                found_.high = glm::max(found_.high, p);
            }
        step_ = step;
    }
    bool Passes(const Point2 &p) const {
        for (Float x : film_) {
            Ray ray;
            ray.o = {x, 0, 0};
            ray.d = Normalize(Point3(p, lens_.RearZ()) - ray.o);
            if (lens_.Trace(&ray) > 0) return true;
        }
        return false;
    }

    const LensSystem &lens_;
    std::array<Float, 3> film_;
    Float rear_;
    Bounds2 found_{Point2(Infinity), Point2(-Infinity)};
    Vector2 step_{0};
};

/// Lens for the exit pupil search: round stops that contain the aperture image in any orientation.
LensSystem WithRoundStops(std::vector<LensElement> elements, const ApertureImage &aperture) {
    for (LensElement &e : elements)
        if (e.IsStop()) e.apertureRadius *= aperture.Reach();
    return LensSystem(elements);
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
    auto &[ray, d, weight] = *c;
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
    ray.o = d.rxOrigin = d.ryOrigin = origin;
    ray.d = Normalize(center);
    d.rxDirection = Normalize(right);
    d.ryDirection = Normalize(below);
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
    auto &[ray, d, weight] = *c;
    Point3 center(screen_(sample.pFilm), 0);
    Vector3 right(screen_.StepX(), 0, 0), below(0, screen_.StepY(), 0);
    if (lens_.radius > 0) {
        Point3 origin = PointOnLens(lens_, sample.pLens);
        Vector3 toFocus = center + Vector3(0, 0, lens_.focalDistance) - origin;
        ray.o = d.rxOrigin = d.ryOrigin = origin;
        ray.d = Normalize(toFocus);
        d.rxDirection = Normalize(toFocus + right);
        d.ryDirection = Normalize(toFocus + below);
        return true;
    }
    ray.o = center;
    d.rxOrigin = center + right;
    d.ryOrigin = center + below;
    ray.d = d.rxDirection = d.ryDirection = {0, 0, 1};
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
    auto &[ray, d, weight] = *c;
    // The mappings are not linear, so one-pixel differentials are extrapolated from a small step.
    constexpr Float kStep = 0.05f;
    auto differential = [&](const Vector2 &step) {
        Vector3 delta = Direction(sample.pFilm + step * kStep) - ray.d;
        return Normalize(ray.d + delta / kStep);
    };
    ray.o = d.rxOrigin = d.ryOrigin = Point3(0);
    ray.d = Direction(sample.pFilm);
    d.rxDirection = differential({1, 0});
    d.ryDirection = differential({0, 1});
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

int SphericalCamera::WrappedPositions(const Point2 &pFilm, OtherPlaces &places) const {
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

ExitPupil::ExitPupil(const LensSystem &lens, Float filmRadius) : filmRadius_(filmRadius), bounds_(kSteps) {
    ParallelForEach(kSteps, [&](int64_t i) {
        auto distance = [&](int64_t step) { return Float(step) / kSteps * filmRadius; };
        bounds_[i] = Search(lens, distance(i), distance(i + 1)).Find();
    });
}

const Bounds2 &ExitPupil::Bounds(Float distance) const {
    const int step = int(distance / filmRadius_ * kSteps);
    return bounds_[std::min(step, kSteps - 1)];
}

Point2 ExitPupil::Sample(const Point2 &film, const Point2 &u) const {
    const Float distance = glm::length(film);
    const Point2 p = Bounds(distance).Lerp(u);
    if (!(distance > 0)) return p;
    const Vector2 direction = film / distance;
    return {direction.x * p.x - direction.y * p.y, direction.y * p.x + direction.x * p.y};
}

RealisticCamera::RealisticCamera(const CameraFrame &frame, Float filmDiagonal, std::vector<LensElement> elements,
                                 const ApertureImage &aperture)
    : Camera(frame), lens_(elements, aperture), pupil_(WithRoundStops(elements, aperture), filmDiagonal / 2),
      filmSize_(Vector2(frame.resolution) * (filmDiagonal / glm::length(Vector2(frame.resolution)))) {
    FindFootprint();
}

Point2 RealisticCamera::FilmFromRaster(const Point2 &raster) const {
    const Point2 p = (raster / Point2(Resolution()) - Point2(0.5f)) * filmSize_;
    return {-p.x, p.y};
}

bool RealisticCamera::GenerateInCameraSpace(const CameraSample &sample, CameraRay *c) const {
    const Point2 film = FilmFromRaster(sample.pFilm);
    const Point3 onPupil(pupil_.Sample(film, sample.pLens), lens_.RearZ());
    auto trace = [&](const Point2 &from, Ray *ray) {
        ray->o = Point3(from, 0);
        ray->d = Normalize(onPupil - ray->o);
        return lens_.Trace(ray);
    };
    const Float cosine = Normalize(onPupil - Point3(film, 0)).z;
    const Float passed = trace(film, &c->ray);
    if (passed == 0) return false;
    // The pupil's solid angle: its area under both cosines, at distance z / cosine.
    c->weight = SampledSpectrum(passed * Sqr(Sqr(cosine)) / (pupil_.Pdf(film) * Sqr(lens_.RearZ())));

    // Rays are not linear in the film position and end at the lens border, so one-pixel differentials are extrapolated
    // from a small step to either side.
    auto differential = [&](const Vector2 &axis, Point3 *origin, Vector3 *direction) {
        for (Float step : {Float(0.05), Float(-0.05)}) {
            Ray next;
            if (trace(FilmFromRaster(sample.pFilm + axis * step), &next) == 0) continue;
            *origin = c->ray.o + (next.o - c->ray.o) / step;
            *direction = Normalize(c->ray.d + (next.d - c->ray.d) / step);
            return true;
        }
        return false;
    };
    RayDifferential &d = c->differential;
    d.valid = differential({1, 0}, &d.rxOrigin, &d.rxDirection) && differential({0, 1}, &d.ryOrigin, &d.ryDirection);
    return true;
}

}  // namespace pbrt
