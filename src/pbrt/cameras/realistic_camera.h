#pragma once
#include "pbrt/cameras/camera_space.h"
#include "pbrt/cameras/exit_pupil.h"

namespace pbrt {

/// A lens of real elements in front of a film at the camera's origin (Kolb, Mitchell and Hanrahan 1995). A unit of
/// camera space is a metre. Rays are weighted such that the mean of the weighted radiance is the irradiance of the
/// film.
class RealisticCamera final : public CameraSpaceCamera {
  public:
    /// `elements` are focused already. `filmDiagonal` in metres.
    RealisticCamera(const CameraFrame &frame, Float filmDiagonal, std::vector<LensElement> elements,
                    const ApertureImage &aperture);

    const LensSystem &Lens() const { return lens_; }
    const ExitPupil &Pupil() const { return pupil_; }
    /// From raster (pixels) to the film (metres). The image on the film is upside down.
    Point2 FilmFromRaster(const Point2 &raster) const;

  protected:
    bool GenerateInCameraSpace(const CameraSample &sample, CameraRay *ray) const override;

  private:
    LensSystem lens_;
    ExitPupil pupil_;
    Vector2 filmSize_;
};

}  // namespace pbrt
