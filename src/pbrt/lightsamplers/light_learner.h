#pragma once
#include "pbrt/lightsamplers/light_sampler.h"

namespace pbrt {

class Progress;
class SampledSpectrum;

/// A light sampler that goes on learning from the shadow rays of the render. Its probabilities change in Learn only:
/// between waves, after fixed numbers of samples per pixel. So every sample is chosen by what other samples found,
/// which keeps the picture unbiased; and as neither the order of calls nor the thread may matter, it is the same for
/// any number of threads and any split into waves.
class LightLearner {
  public:
    virtual ~LightLearner() = default;
    /// Samples per pixel after which Learn must be called; 0: learning has ended, and Found need not be called.
    virtual int NextLearning() const = 0;
    /// The range of memory places that a path may fill, one for each call of Found. The path keeps it.
    struct PathPlaces {
        size_t next = 0, end = 0;
    };
    /// The places for the path of a sample of a pixel.
    virtual PathPlaces BeginPath(Point2i pixel, int sample) const = 0;
    /// What the shadow ray to a chosen light found at a vertex of that path: radiance times cosine over the density of
    /// the point on the light (solid angle), without BSDF and `light.pmf`; 0 where it was blocked or nothing arrives.
    virtual void Found(PathPlaces &path, const LightQuery &query, const SampledLight &light,
                       const SampledSpectrum &found) = 0;
    /// Several processes may render the same pass, each some of its samples. Before Learn, and before what was learned
    /// is saved, what each of them found is brought together: Take writes what was found and forgets it, Add takes it
    /// up. Any order and any division give the same.
    virtual void TakeFound(StateWriter &out) = 0;
    /// Throws UserError if it is not of this learner.
    virtual void AddFound(StateReader &in) = 0;
    /// May take seconds. If `progress` is cancelled meanwhile, it gives up soon and leaves everything as it was before.
    virtual void Learn(const Progress &progress) = 0;
};

}  // namespace pbrt
