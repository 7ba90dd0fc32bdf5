#include "pbrt/cameras/realistic_camera.h"

namespace pbrt {
namespace {

/// Lens for the exit pupil search: round stops that contain the aperture image in any orientation.
LensSystem WithRoundStops(std::vector<LensElement> elements, const ApertureImage &aperture) {
    for (LensElement &e : elements)
        if (e.IsStop()) e.apertureRadius *= aperture.Reach();
    return LensSystem(elements);
}

}  // namespace

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
