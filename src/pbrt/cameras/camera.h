#pragma once
#include <array>
#include <memory>
#include <optional>

#include "pbrt/core/factory_table.h"
#include "pbrt/core/files.h"
#include "pbrt/math/animated_transform.h"
#include "pbrt/math/ray.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

struct CameraSample {
    Point2 pFilm{};  ///< raster position in pixels
    Point2 pLens{};  ///< unit square
    Float time = 0;  ///< [0, 1)
    Float filterWeight = 1;
};

struct CameraRay {
    Ray ray;  ///< rendering space, unit direction
    RayDifferential differential;
    SampledSpectrum weight{1};  ///< factor of the radiance along the ray
};

struct CameraConnection {
    Point3 p{};      ///< point on the lens, rendering space
    Vector3 wi{};    ///< unit, from the point to the camera
    Point2 pFilm{};  ///< raster position, possibly outside the film
    /// Radiance L leaving area dA towards wi at angle theta from its normal adds L cos(theta) dA * weight to the mean
    /// over the pixel at pFilm. Independent of distance if the camera IsParallel.
    Float weight = 0;
};

/// Placement, image and exposure of a camera.
struct CameraFrame {
    AnimatedTransform renderFromCamera;
    Point2i resolution{1, 1};                 ///< pixels of the whole film
    Float shutterOpen = 0, shutterClose = 1;  ///< times of rays, in the unit of TransformTimes
};

/// Cameras are defined in camera space: at the origin, looking along +z, x right, y up. This base transforms to
/// rendering space and computes footprints. Derived constructors must end with FindFootprint().
class Camera {
  public:
    virtual ~Camera() = default;
    /// True if light paths can connect to the camera (Connect).
    virtual bool CanConnect() const { return false; }
    /// Connects `p` (rendering space) to a lens point sampled by `uLens` as in GenerateRay; empty if behind the camera.
    /// The caller tests visibility.
    std::optional<CameraConnection> Connect(const Point3 &p, const Point2 &uLens, Float time) const;
    /// Weight of Connect for a point at distance 1 in unit direction `d` (rendering space), if some ray of the camera
    /// has that direction; else 0. It is the density of a pixel's rays, by solid angle, or by area across them for
    /// parallel views.
    Float RayWeight(const Vector3 &d, Float time) const;
    virtual bool IsParallel() const { return false; }
    /// For cameras whose image wraps around: equivalent film positions outside the film, so that filters reach pixels
    /// at opposite edges. At most the first repetition in each direction. Returns their number.
    using OtherPlaces = std::array<Point2, 8>;
    virtual int WrappedPositions(const Point2 & /*pFilm*/, OtherPlaces &) const { return 0; }
    std::optional<CameraRay> GenerateRay(const CameraSample &sample, const SampledWavelengths &lambda) const;
    /// Footprint of one of `samplesPerPixel` samples at a point not directly visible: dp/dx, dp/dy from the smallest
    /// differentials over the film, scaled to the spacing of the samples, at least 1/8 of a pixel. The point is taken
    /// as straight ahead. Zero if the tangent plane is edge-on or `n` is 0. `p`, `n` in rendering space.
    void ApproximateFootprint(const Point3 &p, const Normal3 &n, Float time, int samplesPerPixel, Vector3 *dpdx,
                              Vector3 *dpdy) const;
    Transform CameraFromRender(Float time) const { return frame_.renderFromCamera.At(time).Inverse(); }
    /// Camera space to NDC [0,1]^3 for image metadata; nullopt without projection.
    virtual std::optional<Transform> NdcFromCamera() const { return {}; }
    Float ShutterOpen() const { return frame_.shutterOpen; }
    Float ShutterClose() const { return frame_.shutterClose; }

  protected:
    explicit Camera(const CameraFrame &frame) : frame_(frame) {}
    /// Fills origin, unit direction, differentials (valid unless cleared) and weight, if not 1, in camera space. False:
    /// the film position receives no light.
    virtual bool GenerateInCameraSpace(const CameraSample &sample, CameraRay *ray) const = 0;
    /// Fills p and pFilm in camera space. False: the point is not visible.
    virtual bool ConnectInCameraSpace(const Point3 & /*p*/, const Point2 & /*uLens*/, CameraConnection *) const {
        return false;
    }
    /// Weight of a connection (camera space) along `d`, not zero, from the lens point.
    virtual Float WeightInCameraSpace(const Vector3 & /*d*/) const { return 0; }
    void FindFootprint();
    Point2i Resolution() const { return frame_.resolution; }

  private:
    Float WeightAlong(const Transform &renderFromCamera, const Vector3 &d) const;
    CameraFrame frame_;
    /// Smallest steps between neighbouring pixels' rays over the film, in camera space. Directions are relative to a
    /// frame with z along the ray.
    struct {
        Vector3 positionX{0}, positionY{0};
        Vector3 directionX{0}, directionY{0};
    } smallest_;
};

struct CameraContext {
    const AnimatedTransform &renderFromCamera;
    Point2i resolution{1, 1};  ///< of the full film
    Float filmDiagonalMm = 35;
    const FileResolver &files;
    DiagnosticSink &sink;
};

/// Exposure time in seconds from a camera's parameters. Their errors are reported when the camera is created.
Float ExposureTime(const ParamSet &params);

using CameraTable = FactoryTable<std::unique_ptr<Camera>, const CameraContext>;
const CameraTable &Cameras();

}  // namespace pbrt
