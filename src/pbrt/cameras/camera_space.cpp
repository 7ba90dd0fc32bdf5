#include "pbrt/cameras/camera_space.h"

#include "pbrt/math/transform.h"

namespace pbrt {

CameraSpaceCamera::CameraSpaceCamera(const CameraFrame &frame)
    : renderFromCamera_(frame.renderFromCamera), resolution_(frame.resolution) {
    shutterOpen_ = frame.shutterOpen;
    shutterClose_ = frame.shutterClose;
}

void CameraSpaceCamera::FindFootprint() {
    smallest_ = FindSmallestDifferentials(resolution_, [this](const Point2 &film, Ray *ray, RayDifferential *d) {
        CameraRay c;
        c.differential.valid = true;
        bool seen = GenerateInCameraSpace({film, {0.5f, 0.5f}, 0.5f, 1}, &c) && c.differential.valid;
        *ray = c.ray;
        *d = c.differential;
        return seen;
    });
}

std::optional<CameraRay> CameraSpaceCamera::GenerateRay(const CameraSample &sample, const SampledWavelengths &) const {
    CameraRay c;
    c.differential.valid = true;
    if (!GenerateInCameraSpace(sample, &c)) return {};
    c.ray.time = Lerp(sample.time, shutterOpen_, shutterClose_);
    const Transform t = renderFromCamera_.At(c.ray.time);
    c.ray.o = t.Point(c.ray.o);
    c.ray.d = Normalize(t.Vector(c.ray.d));
    c.differential.rxOrigin = t.Point(c.differential.rxOrigin);
    c.differential.ryOrigin = t.Point(c.differential.ryOrigin);
    c.differential.rxDirection = Normalize(t.Vector(c.differential.rxDirection));
    c.differential.ryDirection = Normalize(t.Vector(c.differential.ryDirection));
    return c;
}

std::optional<CameraConnection> CameraSpaceCamera::Connect(const Point3 &p, const Point2 &uLens, Float time) const {
    const Transform t = renderFromCamera_.At(time);
    // Subtracts first: far from the rendering-space origin the inverse of a point loses precision.
    const Point3 inCamera = t.InverseVector(p - t.Point(Point3(0)));
    CameraConnection c;
    if (!ConnectInCameraSpace(inCamera, uLens, &c)) return {};
    const Vector3 d = inCamera - c.p;
    c.weight = WeightAlong(t, d);
    if (!(c.weight > 0)) return {};
    c.p = t.Point(c.p);
    c.wi = -Normalize(t.Vector(d));
    return c;
}

Float CameraSpaceCamera::RayWeight(const Vector3 &d, Float time) const {
    const Transform t = renderFromCamera_.At(time);
    return WeightAlong(t, t.InverseVector(d));
}

/// The weight is an importance by area across the ray: of a lens at a distance, or of a parallel view.
Float CameraSpaceCamera::WeightAlong(const Transform &renderFromCamera, const Vector3 &d) const {
    return WeightInCameraSpace(d) * (Length(renderFromCamera.Vector(Normalize(d))) / VolumeScale(renderFromCamera));
}

void CameraSpaceCamera::ApproximateFootprint(const Point3 &p, const Normal3 &n, Float time, int samplesPerPixel,
                                             Vector3 *dpdx, Vector3 *dpdy) const {
    const Transform t = renderFromCamera_.At(time);
    FootprintOnTangentPlane(smallest_, t.InversePoint(p), t.InverseNormal(n), dpdx, dpdy);
    Float scale = DifferentialScale(samplesPerPixel);
    *dpdx = t.Vector(*dpdx * scale);
    *dpdy = t.Vector(*dpdy * scale);
}

}  // namespace pbrt
