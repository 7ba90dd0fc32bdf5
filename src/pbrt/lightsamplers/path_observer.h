#pragma once
#include "pbrt/lightsamplers/light_sampler.h"

namespace pbrt {

class SampledSpectrum;

/// Extension point: records the light samples of camera paths. Called concurrently for different paths.
class PathObserver {
  public:
    virtual ~PathObserver() = default;
    /// Range of record slots for a path, one per light sample; stored by the path.
    struct PathPlaces {
        size_t next = 0, end = 0;
    };
    virtual PathPlaces BeginPath(Point2i pixel, int sample) const = 0;
    /// Records the light sample of a path vertex: radiance times cosine over the density of the point on the light
    /// (solid angle), without BSDF and `light.pmf`; 0 if occluded or dark.
    virtual void RecordLightSample(PathPlaces &path, const LightQuery &query, const SampledLight &light,
                                   const SampledSpectrum &irradiance) = 0;
};

}  // namespace pbrt
