#include "ext/guiding/guided_directions.h"
#include "pbrt/integrators/camera_path.h"

namespace ext {

SampledSpectrum PathGuide::Li(const CameraPathSetup &setup, const CameraPathStart &start, SampledWavelengths &lambda,
                              Sampler &sampler) {
    GuidedDirections directions(*this, start.pixel, start.sampleIndex);
    if (setup.settings.tracksMedia)
        return CameraPath<MediaThroughput, GuidedDirections>(setup, start, lambda, sampler, directions).Follow();
    return CameraPath<SurfaceThroughput, GuidedDirections>(setup, start, lambda, sampler, directions).Follow();
}

}  // namespace ext
