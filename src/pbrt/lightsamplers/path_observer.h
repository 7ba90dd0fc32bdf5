#pragma once
#include "pbrt/lightsamplers/light_sampler.h"

namespace pbrt {

class SampledSpectrum;

/// Extension point: records the light samples of camera paths. Paths are followed by several threads at once.
class PathObserver {
  public:
    virtual ~PathObserver() = default;
    /// The range of places for records that a path may fill, one for each light sample. The path keeps it.
    struct PathPlaces {
        size_t next = 0, end = 0;
    };
    /// The places for the path of a sample of a pixel.
    virtual PathPlaces BeginPath(Point2i pixel, int sample) const = 0;
    /// Records the light sample of a vertex of that path: radiance times cosine over the density of the point on the
    /// light (solid angle), without BSDF and `light.pmf`; 0 where the shadow ray was blocked or nothing arrives.
    virtual void RecordLightSample(PathPlaces &path, const LightQuery &query, const SampledLight &light,
                                   const SampledSpectrum &irradiance) = 0;
};

}  // namespace pbrt
