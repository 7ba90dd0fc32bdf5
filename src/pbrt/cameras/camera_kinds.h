#pragma once
#include <optional>
#include <span>
#include <vector>

#include "pbrt/cameras/camera.h"
#include "pbrt/core/files.h"
#include "pbrt/images/image.h"
#include "pbrt/math/bounds.h"
#include "pbrt/math/ray.h"

namespace pbrt {

/// Transmittance over an aperture stop, scaled to the total of an open disk.
class ApertureImage {
  public:
    /// Empty: a disk.
    ApertureImage() = default;
    /// `image`: one channel, >= 0, not all black; row 0 is the bottom (-y).
    explicit ApertureImage(Image image);

    /// Built-in shape or image file `name`; empty if the name is empty. Throws UserError (no location).
    static ApertureImage Read(const std::string &name, const FileResolver &files);

    explicit operator bool() const { return bool(image_); }
    /// `p` in units of the stop's radius; 0 outside [-1, 1]^2.
    Float Lookup(const Point2 &p) const { return image_.Bilinear((p + Point2(1)) / Float(2), 0, WrapMode::Black); }
    /// Largest radius that passes light, in units of the stop's radius.
    Float Reach() const { return reach_; }

  private:
    Image image_;
    Float reach_ = 1;
};

/// A line of a lens file, in metres. Elements are listed from scene to film.
struct LensElement {
    Float curvatureRadius = 0;  ///< above 0: convex towards the scene; 0: an aperture stop
    Float thickness = 0;        ///< distance to the next element or the film
    Float index = 1;            ///< refractive index between this element and the next
    Float apertureRadius = 0;
    bool IsStop() const { return curvatureRadius == 0; }
};

/// Reads a lens file (pbrt-v4-format §15). Throws UserError (no location).
std::vector<LensElement> ReadLensFile(const std::string &path);

/// Paraxial optics of a lens in air, metres.
struct CardinalPoints {
    double focalLength = 0;     ///< infinite or NaN for an afocal lens
    double rearPrincipal = 0;   ///< from the last element's vertex towards the scene
    double frontPrincipal = 0;  ///< from the first element's vertex towards the film
};
CardinalPoints ComputeCardinalPoints(std::span<const LensElement> elements);

/// Distance from the last element to the film that focuses the plane at `distance` from the film, for small angles.
/// Empty if there is none.
std::optional<double> FocusedThickness(std::span<const LensElement> elements, double distance);

/// Spherical surfaces and stops around the z axis: film at z = 0, scene towards +z. Metres.
class LensSystem {
  public:
    /// `elements`: from scene to film, the last thickness reaching the film. A non-empty `aperture` replaces the stops'
    /// round holes.
    explicit LensSystem(std::span<const LensElement> elements, const ApertureImage &aperture = {});

    Float RearZ() const { return surfaces_.front().z; }  ///< vertex of the rear element
    Float FrontZ() const { return surfaces_.back().z; }  ///< vertex of the front element
    Float RearRadius() const { return surfaces_.front().apertureRadius; }

    /// Traces a ray from behind the lens (d unit, towards +z) to the front. Returns the fraction of light that passes;
    /// if 0, the ray is undefined.
    Float Trace(Ray *ray) const;

  private:
    struct Surface {
        Float curvature;  ///< 1 / radius, above 0 convex towards the scene; 0: a stop
        Float z;          ///< of the vertex
        Float apertureRadius;
        Float relativeIndex;  ///< before over behind, along the ray
    };
    std::vector<Surface> surfaces_;  ///< from the film to the scene
    ApertureImage aperture_;
};

struct ScreenWindow {
    Float xMin = -1, xMax = 1, yMin = -1, yMax = 1;
};

struct Lens {
    Float radius = 0;
    Float focalDistance = 1e6f;  ///< camera space; plane of focus z = focalDistance
};

/// Maps raster positions (pixels, y down) to the screen window.
class RasterToScreen {
  public:
    RasterToScreen(const ScreenWindow &window, Point2i resolution)
        : origin_(window.xMin, window.yMax), dx_((window.xMax - window.xMin) / Float(resolution.x)),
          dy_((window.yMin - window.yMax) / Float(resolution.y)) {}
    Point2 operator()(const Point2 &raster) const { return {origin_.x + raster.x * dx_, origin_.y + raster.y * dy_}; }
    Point2 Inverse(const Point2 &screen) const { return {(screen.x - origin_.x) / dx_, (screen.y - origin_.y) / dy_}; }
    Float PixelArea() const { return std::abs(dx_ * dy_); }
    Float StepX() const { return dx_; }  ///< per pixel to the right
    Float StepY() const { return dy_; }  ///< per pixel down

  private:
    Point2 origin_;
    Float dx_, dy_;
};

class PerspectiveCamera final : public Camera {
  public:
    /// `fovDegrees`: full angle between screen positions -1 and 1.
    PerspectiveCamera(const CameraFrame &frame, const ScreenWindow &window, Float fovDegrees, const Lens &lens);
    std::optional<Transform> NdcFromCamera() const override;
    bool CanConnect() const override { return true; }

  protected:
    bool GenerateInCameraSpace(const CameraSample &sample, CameraRay *ray) const override;
    bool ConnectInCameraSpace(const Point3 &p, const Point2 &uLens, CameraConnection *c) const override;
    Float WeightInCameraSpace(const Vector3 &d) const override;

  private:
    RasterToScreen screen_;
    Float fovDegrees_, tanHalfFov_;
    Lens lens_;
};

/// Screen positions are camera-space x and y. As in stock pbrt-v4, with a lens all rays start on one disk about the
/// camera's origin. The result is a perspective view onto the plane of focus.
class OrthographicCamera final : public Camera {
  public:
    OrthographicCamera(const CameraFrame &frame, const ScreenWindow &window, const Lens &lens);
    std::optional<Transform> NdcFromCamera() const override;
    bool CanConnect() const override { return true; }
    bool IsParallel() const override { return !(lens_.radius > 0); }

  protected:
    bool GenerateInCameraSpace(const CameraSample &sample, CameraRay *ray) const override;
    bool ConnectInCameraSpace(const Point3 &p, const Point2 &uLens, CameraConnection *c) const override;
    Float WeightInCameraSpace(const Vector3 &d) const override;

  private:
    RasterToScreen screen_;
    Lens lens_;
};

enum class SphericalCameraMapping { EqualArea, Equirectangular };

/// Omnidirectional camera; the top of the image is +y.
class SphericalCamera final : public Camera {
  public:
    SphericalCamera(const CameraFrame &frame, SphericalCameraMapping mapping);
    bool CanConnect() const override { return true; }
    int WrappedPositions(const Point2 &pFilm, OtherPlaces &places) const override;

  protected:
    bool GenerateInCameraSpace(const CameraSample &sample, CameraRay *ray) const override;
    bool ConnectInCameraSpace(const Point3 &p, const Point2 &uLens, CameraConnection *c) const override;
    Float WeightInCameraSpace(const Vector3 &d) const override;

  private:
    Vector3 Direction(const Point2 &film) const;
    SphericalCameraMapping mapping_;
};

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
