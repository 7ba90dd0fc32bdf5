#pragma once
#include "pbrt/cameras/camera.h"
#include "pbrt/cameras/footprint.h"

namespace pbrt {

struct CameraFrame {
    AnimatedTransform renderFromCamera;
    Point2i resolution{1, 1};
    Float shutterOpen = 0, shutterClose = 1;
};

/// Base of cameras defined in camera space: at the origin, looking along +z, x right, y up. Transforms to rendering
/// space and computes footprints. Derived constructors must end with FindFootprint().
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
    /// Fills origin, unit direction, differentials (valid unless cleared) and weight, if not 1, in camera space. False:
    /// the film position receives no light.
    virtual bool GenerateInCameraSpace(const CameraSample &sample, CameraRay *ray) const = 0;
    /// Fills p and pFilm in camera space. False: the point is not visible.
    virtual bool ConnectInCameraSpace(const Point3 &p, const Point2 &uLens, CameraConnection *c) const {
        (void)p;
        (void)uLens;
        (void)c;
        return false;
    }
    /// Weight of a connection (camera space) along `d`, not zero, from the lens point.
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
