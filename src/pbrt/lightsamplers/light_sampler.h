#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "pbrt/core/ids.h"
#include "pbrt/core/progress.h"
#include "pbrt/core/team.h"
#include "pbrt/lights/light.h"
#include "pbrt/math/bounds.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/vec.h"

namespace pbrt {

/// Scratch memory for a light sampler's weights at one vertex, owned by the caller, e.g. on the stack. 4096 bytes are
/// inline; only the excess is allocated on the heap.
class LightMemory {
  public:
    LightMemory() = default;
    LightMemory(const LightMemory &) = delete;
    LightMemory &operator=(const LightMemory &) = delete;

    /// Invalidates all allocations.
    void Clear() {
        used_ = 0;
        if (!larger_.empty()) larger_.clear();
    }
    /// Allocates a T or `count` of them, cache-line aligned and uninitialized.
    template <class T>
    T *Make(size_t count = 1) {
        static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= kAlignment);
        const size_t bytes = (count * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
        if (bytes > sizeof(inside_) - used_) return new (Larger(bytes)) T[count];
        std::byte *place = inside_ + used_;
        used_ += bytes;
        return new (place) T[count];
    }

  private:
    static constexpr size_t kAlignment = 64;
    struct alignas(kAlignment) Line {
        std::byte bytes[kAlignment];
    };
    [[gnu::cold]] void *Larger(size_t bytes) {
        larger_.push_back(std::make_unique_for_overwrite<Line[]>(bytes / kAlignment));
        return larger_.back().get();
    }

    size_t used_ = 0;
    std::vector<std::unique_ptr<Line[]>> larger_;
    alignas(kAlignment) std::byte inside_[4096];
};

class Scene;
class Bsdf;
class HenyeyGreenstein;
class Camera;
class Filter;
class Sampler;
class SampledWavelengths;
class OnlineModel;
class PathObserver;
class StateReader;
class StateWriter;

/// Vertex data available to a light sampler.
struct LightQuery {
    Point3 p{};
    Vector3 wo{};
    Normal3 n{}, ns{};       ///< geometric and shading normal; zero inside a medium
    bool transmits = false;  ///< the BSDF can transmit light through the surface
    MediumId medium{};
    Float time = 0;
    int depth = 0;
    /// Scattering at p and its wavelengths; null if unavailable. Read by LightSampler::At only.
    const Bsdf *bsdf = nullptr;
    const SampledWavelengths *lambda = nullptr;
    Vector3 pError{};                         ///< error bounds of p: offset of rays that leave it (LightSampleContext)
    const HenyeyGreenstein *phase = nullptr;  ///< in a medium, instead of a BSDF; read by At only
};

/// Named value of a sampler at a query point: see LightSampler::Inspect.
struct InspectedValue {
    std::string name;
    double value = 0;
    bool isId = false;  ///< shown as a colour, not a magnitude
};

/// A light selected at a query point. Its contribution is divided by `pmf` and the density of the sampled point.
struct SampledLight {
    LightId light{};
    Float pmf = 0;  ///< discrete probability of light and region
    /// Set by samplers that learn (PathObserver): the light's estimated unoccluded contribution, and its share of the
    /// sum over all lights divided by the selection probability.
    Float unoccluded = 0, weight = 0;
    EnvironmentRegion region{};  ///< of an environment light, from which to sample the point (LightTable::Region)
};

/// Arguments of LightSampler::Prepare. The scene outlives the sampler; all else is valid during that call only.
struct PrepareContext {
    const Scene &scene;
    const Camera &camera;
    const Filter &filter;
    const Sampler &sampler;  ///< of the render's pixels
    Bounds2i pixelBounds;    ///< pixels to be rendered
    int seed = 0;
    int samplesPerPixel = 1;  ///< to be rendered (an estimate with --time)
    int maxDepth = 5;         ///< of the integrator
    Progress &progress;
    /// If set, the output of SaveLearned of the same sampler over the same lights, to be loaded instead of learned.
    StateReader *learned = nullptr;
    bool learnsOn = true;        ///< false: with `learned`, the render does not update the model
    Team &team = Team::Alone();  ///< processes that prepare the same sampler concurrently
    /// Extension point: traces a camera path of the render with the light sampler in its present state and BSDF
    /// directions, for choices by measurement. Returns its radiance, mean over wavelengths, times its filter weight; 0
    /// if that is not finite. `sample`: for the PathObserver; `sampler`: at the start of a pixel sample. Counted in the
    /// statistics. Null if the integrator has no such paths. Callable concurrently.
    std::function<double(Point2i pixel, int sample, Sampler &sampler)> tracePath{};
};

class LightSampler;

/// Selection probabilities of all lights at one vertex, evaluated once by LightSampler::At. A small value that refers
/// to sampler, query and memory; all three must stay unchanged during its use. The query's `bsdf` and `lambda` are not
/// used after At.
class LightDistribution {
  public:
    LightDistribution() = default;
    /// Samples a light with its probability, from a uniform number; empty if no light can contribute. `uPoint`: uniform
    /// on the unit square, for the point on the light. Selection among regions of an environment light consumes part of
    /// it and remaps it to uniform, preserving stratification.
    std::optional<SampledLight> Sample(Float u, Point2 *uPoint) const;
    /// The same without a point: a hash of u replaces it.
    std::optional<SampledLight> Sample(Float u) const;
    /// Discrete probability of a light over all its regions; bit-identical to the `pmf` of a sample without region.
    Float PMF(LightId light) const;
    /// Light, region and probability for MIS of a ray from p that leaves the scene in direction d (unit) towards an
    /// infinite light. p: that of PdfLi's LightSampleContext.
    SampledLight Towards(LightId infinite, const Point3 &p, const Vector3 &d) const;
    const LightQuery &Query() const { return *query_; }

  private:
    friend class LightSampler;
    LightDistribution(const LightSampler &sampler, const LightQuery &query, const void *weights)
        : sampler_(&sampler), query_(&query), weights_(weights) {}
    const LightSampler *sampler_ = nullptr;
    const LightQuery *query_ = nullptr;
    const void *weights_ = nullptr;
};

/// Selects lights for shadow rays. Contract (tests/contract):
/// - const after Prepare, except for its online model, if any;
/// - Sample's probability equals PMF (with a region, that of Towards) exactly;
/// - probabilities sum to 1 (or less, if Sample may return nothing), and are positive wherever a light contributes;
/// - a selection takes one random number; selection among regions consumes part of the point's.
class LightSampler {
  public:
    virtual ~LightSampler() = default;
    virtual void Prepare(PrepareContext &) {}  ///< once, before At; may trace rays, and throws UserError
    /// Evaluates the lights at a vertex, in the caller's memory; allocates only if that is too small. Invalidates
    /// earlier results in the memory.
    LightDistribution At(const LightQuery &query, LightMemory &memory) const {
        memory.Clear();
        return Within(query, memory);
    }
    /// At for nested samplers: earlier results in the memory stay valid.
    LightDistribution Within(const LightQuery &query, LightMemory &memory) const {
        return {*this, query, Weigh(query, memory)};
    }
    /// At and a single query. For several queries at a vertex, use At.
    std::optional<SampledLight> Sample(const LightQuery &query, Float u) const {
        LightMemory memory;
        return At(query, memory).Sample(u);
    }
    Float PMF(const LightQuery &query, LightId light) const {
        LightMemory memory;
        return At(query, memory).PMF(light);
    }
    /// Model updated between waves from its observer's records; null if nothing is learned after Prepare.
    virtual OnlineModel *Model() { return nullptr; }
    virtual PathObserver *Observer() { return nullptr; }
    /// True if samples can have regions of environment lights. Only after Prepare.
    virtual bool ChoosesRegions() const { return false; }
    /// True if camera paths learn Russian roulette unless they are guided.
    virtual bool LearnsRoulette() const { return false; }
    /// True if SaveLearned writes state. Other samplers are rebuilt by Prepare, bit-identically for equal scene,
    /// camera, seed and PrepareContext numbers.
    virtual bool SavesLearned() const { return false; }
    /// Writes the state of Prepare and the online model, for PrepareContext::learned; the writer may refer to memory of
    /// this object. `withLearning` false: only the state for selection, not for learning. Not while rays are traced.
    virtual void SaveLearned(StateWriter &, bool /*withLearning*/) const {}
    /// Sizes, seconds, counts: for --stats and image metadata.
    virtual void Report(nlohmann::ordered_json &) const {}
    /// Sampler state at a point (cell, records, ...): same names and order for every query. For visualization; slow.
    virtual void Inspect(const LightQuery &, std::vector<InspectedValue> &) const {}
    /// Multi-line description of the learned structure; empty if there is none.
    virtual std::string DescribeStructure() const { return {}; }

  protected:
    friend class LightDistribution;
    /// Computes, in `memory`, the shared input of the functions below; may return null.
    virtual const void *Weigh(const LightQuery &, LightMemory &) const { return nullptr; }
    /// See LightDistribution::Sample and PMF. `weights`: result of Weigh for the query.
    virtual std::optional<SampledLight> Choose(const LightQuery &query, const void *weights, Float u,
                                               Point2 *uPoint) const = 0;
    virtual Float Probability(const LightQuery &query, const void *weights, LightId light) const = 0;
    /// See LightDistribution::Towards.
    virtual SampledLight ChoiceTowards(const LightQuery &query, const void *weights, LightId infinite, const Point3 &,
                                       const Vector3 &) const {
        return {infinite, Probability(query, weights, infinite)};
    }
};

inline std::optional<SampledLight> LightDistribution::Sample(Float u, Point2 *uPoint) const {
    return sampler_->Choose(*query_, weights_, u, uPoint);
}
inline std::optional<SampledLight> LightDistribution::Sample(Float u) const {
    Point2 uPoint(HashToFloat(Hash(u, 0)), HashToFloat(Hash(u, 1)));
    return Sample(u, &uPoint);
}
inline Float LightDistribution::PMF(LightId light) const { return sampler_->Probability(*query_, weights_, light); }
inline SampledLight LightDistribution::Towards(LightId infinite, const Point3 &p, const Vector3 &d) const {
    return sampler_->ChoiceTowards(*query_, weights_, infinite, p, d);
}

class SampledSpectrum;

/// Extension point: records the light samples of camera paths. Called concurrently for different paths.
class PathObserver {
  public:
    virtual ~PathObserver() = default;
    /// Range of record slots for a path, one per light sample; stored by the path. Empty: the path is not recorded.
    struct PathPlaces {
        size_t next = 0, end = 0;
    };
    virtual PathPlaces BeginPath(Point2i pixel, int sample) const = 0;
    /// Records the light sample of a path vertex: radiance times cosine over the density of the point on the light
    /// (solid angle), without BSDF and `light.pmf`; 0 if occluded or dark. Not called when `path` has no slot left.
    virtual void RecordLightSample(PathPlaces &path, const LightQuery &query, const SampledLight &light,
                                   const SampledSpectrum &irradiance) = 0;
};

}  // namespace pbrt
