#pragma once
#include "pbrt/cameras/camera.h"

namespace pbrt {

enum class SphericalCameraMapping { EqualArea, Equirectangular };

/// Omnidirectional camera; the top of the image is +y.
class SphericalCamera final : public Camera {
  public:
    SphericalCamera(const CameraFrame &frame, SphericalCameraMapping mapping);
    bool CanConnect() const override { return true; }
    int SeenAlsoAt(const Point2 &pFilm, OtherPlaces &places) const override;

  protected:
    bool GenerateInCameraSpace(const CameraSample &sample, CameraRay *ray) const override;
    bool ConnectInCameraSpace(const Point3 &p, const Point2 &uLens, CameraConnection *c) const override;
    Float WeightInCameraSpace(const Vector3 &d) const override;

  private:
    Vector3 Direction(const Point2 &film) const;
    SphericalCameraMapping mapping_;
};

}  // namespace pbrt
