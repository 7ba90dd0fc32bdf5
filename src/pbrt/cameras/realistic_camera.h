#pragma once
#include "pbrt/cameras/camera.h"
#include "pbrt/cameras/exit_pupil.h"

namespace pbrt {

/// Lens of real elements in front of a film at the camera's origin (Kolb, Mitchell and Hanrahan 1995). Camera space is
/// in metres. Rays are weighted so that the mean weighted radiance is the film's irradiance.
class RealisticCamera final : public Camera {
  public:
    /// `elements` are already focused. `filmDiagonal` in metres.
    RealisticCamera(const CameraFrame &frame, Float filmDiagonal, std::vector<LensElement> elements,
                    const ApertureImage &aperture);

    const LensSystem &Lens() const { return lens_; }
    const ExitPupil &Pupil() const { return pupil_; }
    /// Maps raster (pixels) to film (metres). The image on the film is upside down.
    Point2 FilmFromRaster(const Point2 &raster) const;

  protected:
    bool GenerateInCameraSpace(const CameraSample &sample, CameraRay *ray) const override;

  private:
    LensSystem lens_;
    ExitPupil pupil_;
    Vector2 filmSize_;
};

}  // namespace pbrt
