#pragma once
#include <vector>

#include "pbrt/cameras/camera.h"
#include "pbrt/cameras/lens_system.h"
#include "pbrt/math/bounds.h"

namespace pbrt {

/// Per film point, a rectangle in the plane z = lens.RearZ() that bounds all light reaching it. Metres.
class ExitPupil {
  public:
    /// `lens` must have round stops. `filmRadius`: radius of the film's bounding circle.
    ExitPupil(const LensSystem &lens, Float filmRadius);

    /// Rectangle for film points on the positive x axis at this distance from the axis.
    const Bounds2 &Bounds(Float distance) const;

    /// Samples the film point's rectangle uniformly.
    Point2 Sample(const Point2 &film, const Point2 &u) const;
    /// Density of Sample for that film point, by area.
    Float Pdf(const Point2 &film) const { return 1 / Bounds(glm::length(film)).Area(); }

  private:
    Float filmRadius_;
    std::vector<Bounds2> bounds_;  ///< per equal step of the distance from the axis
};

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
