#pragma once
#include <memory>

#include "pbrt/core/factory_table.h"
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
    /// The sampler for the index-th batch of SamplesPerPixel() samples: a clone for batch 0, else one with a seed that
    /// depends on this one's and the index.
    std::unique_ptr<Sampler> ForBatch(int index) const;

  protected:
    explicit Sampler(int seed) : givenSeed_(seed) {}

  private:
    int givenSeed_;
};

/// What the functions that make samplers need beside the parameters.
struct SamplerContext {
    Point2i resolution{1, 1};  ///< of the full film
    int samplesPerPixel = 0;   ///< if above 0, overrides the parameters (--spp)
    int seed = 0;              ///< used if the parameters give none
    DiagnosticSink &sink;
};

using SamplerTable = FactoryTable<std::unique_ptr<Sampler>, const SamplerContext>;
const SamplerTable &Samplers();

}  // namespace pbrt
