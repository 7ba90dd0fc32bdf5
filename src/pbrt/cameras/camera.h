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

/// Random numbers of one camera sample.
struct CameraSample {
    Point2 pFilm{};  ///< raster position in pixels
    Point2 pLens{};  ///< unit square
    Float time = 0;  ///< [0, 1)
    Float filterWeight = 1;
};

struct CameraRay {
    Ray ray;  ///< rendering space, unit direction
    RayDifferential differential;
    SampledSpectrum weight{1};
};

/// How a camera sees a point.
struct CameraConnection {
    Point3 p{};      ///< where the light arrives, rendering space
    Vector3 wi{};    ///< unit, from the point to the camera
    Point2 pFilm{};  ///< raster position, also outside of the film
    /// Radiance L that leaves an area dA towards wi at an angle theta from its normal adds L cos(theta) dA * weight to
    /// what a pixel at pFilm measures, if it measures the mean over its own area.
    /// The same at every distance if the camera IsParallel.
    Float weight = 0;
};

class Camera {
  public:
    virtual ~Camera() = default;
    /// True if light can be followed to the camera (Connect).
    virtual bool CanConnect() const { return false; }
    /// The point `p` (rendering space) as seen from a place on the lens, drawn by `uLens` as for GenerateRay; empty if
    /// it is behind the camera. The caller tests whether it is occluded.
    virtual std::optional<CameraConnection> Connect(const Point3 &p, const Point2 &uLens, Float time) const {
        (void)p;
        (void)uLens;
        (void)time;
        return {};
    }
    /// The weight that Connect gives to a point at the distance 1 in direction `d` (unit, rendering space), if some ray
    /// of the camera has that direction; else 0. It is the density of the rays of a pixel, by solid angle, or by area
    /// across them if the view is parallel.
    virtual Float RayWeight(const Vector3 &d, Float time) const {
        (void)d;
        (void)time;
        return 0;
    }
    /// True if all rays of the camera have one direction.
    virtual bool IsParallel() const { return false; }
    /// Cameras that see in all directions have a picture that goes on beyond its edges: other places around the film
    /// whose rays are those of a place on the film, so that what is seen there reaches pixels at the opposite edges
    /// through their filter. At most the first repetition in every direction. Returns how many there are.
    using OtherPlaces = std::array<Point2, 8>;
    virtual int SeenAlsoAt(const Point2 &pFilm, OtherPlaces &places) const {
        (void)pFilm;
        (void)places;
        return 0;
    }
    /// Ray through the film position, with the differentials of one pixel step.
    virtual std::optional<CameraRay> GenerateRay(const CameraSample &sample,
                                                 const SampledWavelengths &lambda) const = 0;
    /// Footprint of one of `samplesPerPixel` samples at a point that the camera does not see directly: dp/dx, dp/dy
    /// from the smallest differentials over the film, scaled by DifferentialScale(). `p`, `n` in rendering space.
    virtual void ApproximateFootprint(const Point3 &p, const Normal3 &n, Float time, int samplesPerPixel, Vector3 *dpdx,
                                      Vector3 *dpdy) const = 0;
    virtual Transform CameraFromRender(Float time) const = 0;
    /// Camera space to NDC [0,1]^3 for image metadata; nullopt for cameras without a projection.
    virtual std::optional<Transform> NdcFromCamera() const { return {}; }
    Float ShutterOpen() const { return shutterOpen_; }
    Float ShutterClose() const { return shutterClose_; }

  protected:
    Float shutterOpen_ = 0, shutterClose_ = 1;
};

/// What a camera is made from beside its parameters.
struct CameraContext {
    const AnimatedTransform &renderFromCamera;
    Point2i resolution{1, 1};  ///< of the full film
    Float filmDiagonalMm = 35;
    const FileResolver &files;
    DiagnosticSink &sink;
};

/// Seconds that the shutter is open, from the parameters of a camera. Errors in them are reported when the camera is
/// made.
Float ExposureTime(const ParamSet &params);

using CameraTable = FactoryTable<std::unique_ptr<Camera>, const CameraContext>;
const CameraTable &Cameras();

}  // namespace pbrt
