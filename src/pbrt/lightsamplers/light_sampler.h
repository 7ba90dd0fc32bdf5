#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/core/ids.h"
#include "pbrt/core/progress.h"
#include "pbrt/core/team.h"
#include "pbrt/lights/light.h"
#include "pbrt/lightsamplers/light_memory.h"
#include "pbrt/math/bounds.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/vec.h"

namespace pbrt {

class Scene;
class Bsdf;
class HenyeyGreenstein;
class Camera;
class Filter;
class SampledWavelengths;
class OnlineModel;
class PathObserver;
class StateReader;
class StateWriter;

/// Everything that a light sampler may know about a vertex; a struct, so that members can be added without changing
/// signatures.
struct LightQuery {
    Point3 p{};
    Vector3 wo{};
    Normal3 n{}, ns{};       ///< geometric and shading normal; zero inside a medium
    bool transmits = false;  ///< the BSDF can also send light through the surface
    MediumId medium{};
    Float time = 0;
    int depth = 0;
    /// What scatters at p and at which wavelengths; null if the caller has none. Read by LightSampler::At only.
    const Bsdf *bsdf = nullptr;
    const SampledWavelengths *lambda = nullptr;
    Vector3 pError{};  ///< error bounds of p: rays that leave it start this far off (LightSampleContext)
    const HenyeyGreenstein *phase = nullptr;  ///< inside a medium, in place of a BSDF; read by At only
};

/// A named value that a sampler knows at a query point: see LightSampler::Inspect.
struct InspectedValue {
    std::string name;
    double value = 0;
    bool isId = false;  ///< to be shown as a colour, not as a magnitude
};

struct SampledLight {
    LightId light{};
    Float pmf = 0;  ///< discrete probability, of the light and the region
    /// Set by samplers that learn (PathObserver): the estimated unoccluded contribution of the light; and its share in
    /// the sum over all lights, divided by the probability of choosing the light.
    Float unoccluded = 0, weight = 0;
    EnvironmentRegion region{};  ///< of an environment light, from which the point is to be drawn (LightTable::Region)
};

/// What a sampler may use before the first wave.
struct PrepareContext {
    const Scene &scene;
    const Camera &camera;
    const Filter &filter;
    Bounds2i pixelBounds;  ///< pixels that will be rendered
    int seed = 0;
    int samplesPerPixel = 1;  ///< that will be rendered (an estimate under --time)
    int maxDepth = 5;         ///< of the integrator
    Progress &progress;
    /// If set, what LightSampler::SaveLearned of the same sampler over the same lights wrote: samplers that save
    /// something take it in place of finding it out.
    StateReader *learned = nullptr;
    bool learnsOn = true;        ///< false: with `learned`, nothing is learned from the render
    Team &team = Team::Alone();  ///< the processes that prepare the same sampler at the same time
};

class LightSampler;

/// The probabilities of all lights at one vertex, weighed once by LightSampler::At. A small value that points to the
/// sampler, the query and the memory it was made from; all three must stay as they are while it is asked. The query's
/// `bsdf` and `lambda` are not used after At.
class LightDistribution {
  public:
    LightDistribution() = default;
    /// A light and its probability, from a uniform number; empty if no light can contribute. `uPoint`: uniform on the
    /// unit square, for the point on the light. A choice among regions of an environment light uses a part of it and
    /// leaves the rest, uniform again, so that points well distributed over the square become so over the light.
    std::optional<SampledLight> Sample(Float u, Point2 *uPoint) const;
    /// The same where there is no point: one is made by a hash of u.
    std::optional<SampledLight> Sample(Float u) const;
    /// Discrete probability of a light, in all its regions; bit-identical to the `pmf` of a sample without region.
    Float PMF(LightId light) const;
    /// Light, region and probability of a sample in whose region a ray from p leaves the scene in direction d (unit)
    /// towards an infinite light; for MIS. p: that of the LightSampleContext that PdfLi is called with.
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

/// Chooses the light that gets the shadow ray. Contract (tests/contract): const after Prepare,
/// except for its learner, if any; Sample's probability equals PMF (with a region, that of Towards) exactly;
/// probabilities sum to 1 (or less, when Sample may return nothing); they are positive wherever a light contributes; a
/// choice takes one random number, and a choice among regions a part of the one for the point on the light.
class LightSampler {
  public:
    virtual ~LightSampler() = default;
    virtual void Prepare(PrepareContext &) {}
    /// Weighs the lights at a vertex, in the caller's memory; allocates only if that memory is too small. What was made
    /// in the memory before becomes invalid.
    LightDistribution At(const LightQuery &query, LightMemory &memory) const {
        memory.Clear();
        return Within(query, memory);
    }
    /// At, for a sampler that asks another one: what is in the memory stays valid.
    LightDistribution Within(const LightQuery &query, LightMemory &memory) const {
        return {*this, query, Weigh(query, memory)};
    }
    /// At with a single question. To ask more than once about a vertex, use At.
    std::optional<SampledLight> Sample(const LightQuery &query, Float u) const {
        LightMemory memory;
        return At(query, memory).Sample(u);
    }
    Float PMF(const LightQuery &query, LightId light) const {
        LightMemory memory;
        return At(query, memory).PMF(light);
    }
    /// Null if nothing is learned after Prepare; else what is updated between waves, from records of its observer.
    virtual OnlineModel *Model() { return nullptr; }
    virtual PathObserver *Observer() { return nullptr; }
    /// True if SaveLearned writes something. Other samplers are made anew by Prepare, which gives the same bits
    /// whenever scene, camera, seed and numbers in PrepareContext are the same.
    virtual bool SavesLearned() const { return false; }
    /// Writes all that Prepare and the learner made, for PrepareContext::learned; the writer may refer to memory of
    /// this object. `goesOn` false: only what choosing lights needs, not what learning more needs. Not while rays are
    /// traced.
    virtual void SaveLearned(StateWriter &writer, bool goesOn) const {
        (void)writer;
        (void)goesOn;
    }
    /// Sizes, seconds, counts: for --stats and image metadata.
    virtual void Report(nlohmann::ordered_json &) const {}
    /// What the sampler knows at a point (cell, records, ...): the same names in the same order for every query. For
    /// pictures only, may be slow.
    virtual void Inspect(const LightQuery &, std::vector<InspectedValue> &) const {}
    /// The learned structure in words and numbers, several lines; empty if there is none.
    virtual std::string DescribeStructure() const { return {}; }

  protected:
    friend class LightDistribution;
    /// Computes, in the memory, what both functions below need; null if they need nothing.
    virtual const void *Weigh(const LightQuery &, LightMemory &) const { return nullptr; }
    /// See LightDistribution::Sample and PMF. `weights`: what Weigh returned for the query.
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

}  // namespace pbrt
