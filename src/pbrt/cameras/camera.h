#pragma once
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

class Camera {
  public:
    virtual ~Camera() = default;
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
