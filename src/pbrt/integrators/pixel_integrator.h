#pragma once
#include "pbrt/integrators/integrator.h"
#include "pbrt/transport/path_walk.h"

namespace pbrt {

struct CameraPathStart {
    CameraRay ray;
    Point2i pixel{};
    int sampleIndex = 0;                               ///< of the pixel
    std::optional<VisibleSurface> *visible = nullptr;  ///< null, or receives PathWalk's first visible surface
};

struct PathStart : CameraPathStart {
    const RenderPass &pass;  ///< splatting integrators add to its film
    Float filterWeight = 1;  ///< FilmSample::weight of the sample
    Film *half = nullptr;    ///< null, or AdaptivePass::half, which also gets the splats
};

/// Position, lens point and time of a sample of the pixel, in the order of the sampler's dimensions.
inline CameraSample SampleCamera(const Filter &filter, Point2i pixel, Sampler &sampler) {
    const FilterSample offset = filter.Sample(sampler.GetPixel2D());
    CameraSample sample;
    sample.pFilm = Point2(pixel) + Point2(0.5f, 0.5f) + offset.offset;
    sample.time = sampler.Get1D();
    sample.pLens = sampler.Get2D();
    sample.filterWeight = offset.weight;
    return sample;
}

/// Number in its sampler of a pixel's sample in adaptive renders. Samples alternate between two samplers, which use
/// different sets of `setSize` samples, also where samplers with different seeds share pixel positions.
inline int AdaptiveSampleIndex(int sample, int setSize) {
    const int i = sample / 2;
    return i / setSize * 2 * setSize + sample % 2 * setSize + i % setSize;
}

/// Numbers that select the wavelengths and the time of all samples of a pass.
struct CommonNumbers {
    Float wavelengths = 0, time = 0;
};

/// Base of integrators that compute the radiance of one camera ray for its pixel.
class PixelIntegrator : public Integrator {
  public:
    bool Render(const RenderPass &pass) override;
    virtual SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const = 0;
    /// True if Li adds splats to the pass's film (if RenderPass::keepsSamples), for one light path per call.
    virtual bool Splats() const { return false; }

  protected:
    /// Nothing: each sample has its own.
    virtual std::optional<CommonNumbers> Common() const { return std::nullopt; }
};

}  // namespace pbrt
