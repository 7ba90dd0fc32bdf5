#pragma once
#include <memory>

#include "pbrt/core/factory_table.h"
#include "pbrt/math/lanes.h"
#include "pbrt/math/vec.h"

namespace pbrt {

/// Randomisations that preserve the stratification of low-discrepancy points.
enum class Randomization { None, PermuteDigits, FastOwen, Owen };

/// What samplers are constructed from. Not every kind has a randomization or depends on the resolution.
struct SamplerSettings {
    int samplesPerPixel = 1;
    Point2i resolution{1, 1};  ///< of the full film
    Randomization randomization = Randomization::None;
    int seed = 0;
    uint64_t firstSample = 0;  ///< Sampler::SkipSamples
};

/// Sample values in [0, 1) as a function of (seed, pixel, sample index, dimension) only. Not thread-safe: each thread
/// uses its own Clone(). Indices from SamplesPerPixel() on start another independent set of SamplesPerPixel() samples
/// (or continue the sequence).
///
/// Prepare computes the values of several following dimensions at once, which costs little more than one and saves
/// virtual calls.
class Sampler {
  public:
    explicit Sampler(const SamplerSettings &settings) : settings_(settings) {}
    virtual ~Sampler() = default;
    int SamplesPerPixel() const { return settings_.samplesPerPixel; }
    void StartPixelSample(Point2i pixel, int sampleIndex, int dimension = 0) {  ///< `dimension`: of the next Get
        next_ = end_ = 0;
        firstPrepared_ = StartSample(pixel, sampleIndex, dimension);
    }
    Float Get1D() {
        if (next_ >= end_) [[unlikely]]
            PrepareNext();
        return prepared_.one[next_++];
    }
    Point2 Get2D() {
        if (next_ >= end_) [[unlikely]]
            PrepareNext();
        const Point2 p = prepared_.two[next_];
        next_ += 2;
        return p;
    }
    /// What Get2D will return after `skipped` more dimensions; null if it is not prepared yet.
    const Point2 *Upcoming2D(int skipped) {
        if (next_ >= end_) [[unlikely]]
            PrepareNext();
        return next_ + skipped < end_ ? &prepared_.two[next_ + skipped] : nullptr;
    }
    virtual Point2 GetPixel2D() { return Get2D(); }  ///< position inside the pixel
    virtual std::unique_ptr<Sampler> Clone() const = 0;
    /// Same kind of sampler with another seed. The film positions of "halton" and "sobol" do not depend on the seed.
    virtual std::unique_ptr<Sampler> WithSeed(int seed) const = 0;
    /// Omits samples, if the film positions do not depend on the seed. Samplers that render together need different
    /// seeds and samples.
    void SkipSamples(int64_t count) { settings_.firstSample += uint64_t(count); }
    /// Sampler of the index-th batch of SamplesPerPixel() samples: a clone for batch 0, else one with a seed derived
    /// from this one's and the index. It skips no samples.
    std::unique_ptr<Sampler> ForBatch(int index) const;

  protected:
    static constexpr int kPrepared = 8;
    /// Entry i holds the results of Get1D and Get2D in dimension first + i.
    struct Numbers {
        alignas(32) Float one[kPrepared];
        alignas(32) Point2 two[kPrepared];

        /// For samplers with a point per dimension; Get1D returns its x.
        void SetPoints(const FloatLanes &x, const FloatLanes &y) {
            static_assert(kPrepared == Lanes32Count);
            StoreLanes(x, one);
            StoreLanes(__builtin_shufflevector(x, y, 0, 8, 1, 9, 2, 10, 3, 11), two);
            StoreLanes(__builtin_shufflevector(x, y, 4, 12, 5, 13, 6, 14, 7, 15), two + kPrepared / 2);
        }
        /// For samplers with one number per dimension; the last entry is invalid, because its y is missing.
        void SetSequence(const FloatLanes &v) {
            StoreLanes(v, one);
            StoreLanes(__builtin_shufflevector(v, v, 0, 1, 1, 2, 2, 3, 3, 4), two);
            StoreLanes(__builtin_shufflevector(v, v, 4, 5, 5, 6, 6, 7, 7, 7), two + kPrepared / 2);
        }
    };
    /// A run of prepared dimensions; entries 0 ... count - 1 are valid.
    struct Run {
        int first = 0, count = 0;
    };

    virtual int StartSample(Point2i pixel, int sampleIndex, int dimension) = 0;
    /// Fills numbers for a run of dimensions that contains `dimension`.
    virtual Run Prepare(int dimension, Numbers &numbers) = 0;

    SamplerSettings settings_;

  private:
    void PrepareNext();
    int firstPrepared_ = 0;   ///< dimension of entry 0 of prepared_
    int next_ = 0, end_ = 0;  ///< next entry of prepared_ to use, and number of valid entries
    Numbers prepared_{};
};

/// Base of samplers of type S that are constructed from their settings alone.
template <class S>
class SamplerBySettings : public Sampler {
  public:
    using Sampler::Sampler;
    std::unique_ptr<Sampler> Clone() const final { return std::make_unique<S>(static_cast<const S &>(*this)); }
    std::unique_ptr<Sampler> WithSeed(int seed) const final {
        SamplerSettings settings = settings_;
        settings.seed = seed;
        return std::make_unique<S>(settings);
    }
};

struct SamplerContext {
    Point2i resolution{1, 1};  ///< of the full film
    int samplesPerPixel = 0;   ///< overrides the parameters if above 0 (--spp)
    int seed = 0;              ///< default seed
    DiagnosticSink &sink;
};

using SamplerTable = FactoryTable<std::unique_ptr<Sampler>, const SamplerContext>;
const SamplerTable &Samplers();

}  // namespace pbrt
