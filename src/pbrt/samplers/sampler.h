#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pbrt/core/params.h"
#include "pbrt/math/vec.h"

namespace pbrt {

/// Random numbers for pixel samples: a function of (seed, pixel, sample index, dimension) only. Not thread-safe: each
/// thread works on its own Clone(). All values lie in [0, 1). Sample indices from SamplesPerPixel() on are allowed:
/// they start another, independent set of SamplesPerPixel() samples (or go on with the sequence).
class Sampler {
  public:
    virtual ~Sampler() = default;
    virtual int SamplesPerPixel() const = 0;
    virtual void StartPixelSample(Point2i pixel, int sampleIndex, int dimension = 0) = 0;
    virtual Float Get1D() = 0;
    virtual Point2 Get2D() = 0;
    virtual Point2 GetPixel2D() = 0;  ///< position inside the pixel
    virtual std::unique_ptr<Sampler> Clone() const = 0;
    /// The same kind of samples from another seed.
    virtual std::unique_ptr<Sampler> WithSeed(int seed) const = 0;
    /// For the index-th batch of SamplesPerPixel() samples: this one for the first, then others with seeds of their own.
    std::unique_ptr<Sampler> ForBatch(int index) const;

  protected:
    explicit Sampler(int seed) : givenSeed_(seed) {}

  private:
    int givenSeed_;
};

/// `sppOverride` > 0 replaces pixelsamples (--spp); `defaultSeed` is --seed / Option seed. `resolution`: full film.
/// Unused parameters go to `sink`.
std::unique_ptr<Sampler> MakeSampler(const std::string &type, const ParamSet &params, Point2i resolution,
                                     int sppOverride, int defaultSeed, DiagnosticSink &sink);

const std::vector<std::string> &SupportedSamplers();

}  // namespace pbrt
