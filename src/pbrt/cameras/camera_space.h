#pragma once
#include "pbrt/cameras/camera.h"
#include "pbrt/cameras/footprint.h"

namespace pbrt {

/// Placement, resolution and shutter times of a camera.
struct CameraFrame {
    AnimatedTransform renderFromCamera;
    Point2i resolution{1, 1};
    Float shutterOpen = 0, shutterClose = 1;
};

/// A camera that makes its rays in camera space: at the origin, looking along +z, x right, y up. This class takes them
/// to rendering space and computes footprints. Derived constructors must call FindFootprint() at their end.
class CameraSpaceCamera : public Camera {
  public:
    explicit CameraSpaceCamera(const CameraFrame &frame);
    std::optional<CameraRay> GenerateRay(const CameraSample &sample, const SampledWavelengths &lambda) const final;
    void ApproximateFootprint(const Point3 &p, const Normal3 &n, Float time, int samplesPerPixel, Vector3 *dpdx,
                              Vector3 *dpdy) const final;
    std::optional<CameraConnection> Connect(const Point3 &p, const Point2 &uLens, Float time) const final;
    Float RayWeight(const Vector3 &d, Float time) const final;
    Transform CameraFromRender(Float time) const final { return renderFromCamera_.At(time).Inverse(); }

  protected:
    /// Fills origin, unit direction, differentials (valid unless the camera clears them) and, if it is not 1, the
    /// weight, in camera space. False: no light comes to this place on the film.
    virtual bool GenerateInCameraSpace(const CameraSample &sample, CameraRay *ray) const = 0;
    /// Fills p and pFilm in camera space. False: the camera does not see the point.
    virtual bool ConnectInCameraSpace(const Point3 &p, const Point2 &uLens, CameraConnection *c) const {
        (void)p;
        (void)uLens;
        (void)c;
        return false;
    }
    /// The weight of a connection (camera space) to a point that lies by `d`, not zero, from the place on the lens.
    virtual Float WeightInCameraSpace(const Vector3 &d) const {
        (void)d;
        return 0;
    }
    void FindFootprint();
    Point2i Resolution() const { return resolution_; }

  private:
    Float WeightAlong(const Transform &renderFromCamera, const Vector3 &d) const;
    AnimatedTransform renderFromCamera_;
    Point2i resolution_;
    SmallestDifferentials smallest_;
};

}  // namespace pbrt
