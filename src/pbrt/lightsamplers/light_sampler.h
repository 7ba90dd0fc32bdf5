#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/core/ids.h"
#include "pbrt/core/progress.h"
#include "pbrt/math/bounds.h"
#include "pbrt/math/vec.h"

namespace pbrt {

class Scene;
class Bsdf;
class Camera;
class Filter;
class SampledWavelengths;
class LightLearner;

/// All that is known at the vertex; grows without changing signatures.
struct LightQuery {
    Point3 p{};
    Vector3 wo{};
    Normal3 n{}, ns{};       ///< geometric and shading normal; zero inside a medium
    bool transmits = false;  ///< the BSDF can also send light through the surface
    MediumId medium{};
    Float time = 0;
    int depth = 0;
    /// What scatters at p and at which wavelengths; null where the asker has none. Valid during the call only.
    const Bsdf *bsdf = nullptr;
    const SampledWavelengths *lambda = nullptr;
    Vector3 pError{};  ///< of p: rays that leave it start this far off (LightSampleContext)
};

/// One thing to look at, of a query point: see LightSampler::Inspect.
struct InspectedValue {
    std::string name;
    double value = 0;
    bool isId = false;  ///< to be shown as a colour, not as a magnitude
};

struct SampledLight {
    LightId light{};
    Float pmf = 0;  ///< discrete probability
    /// Of samplers that learn (LightLearner): what they think the light contributes unoccluded, and the share of that
    /// in all lights, over the probability of choosing it.
    Float unoccluded = 0, weight = 0;
};

/// What a sampler may use before the first wave.
struct PrepareContext {
    const Scene &scene;
    const Camera &camera;
    const Filter &filter;
    Bounds2i pixelBounds;      ///< pixels that will be rendered
    int seed = 0;
    int samplesPerPixel = 1;   ///< that will be rendered (an estimate under --time)
    int maxDepth = 5;          ///< of the integrator
    Progress &progress;
};

/// Chooses the light that gets the shadow ray. Contract (house.md §4, tests/contract): const after Prepare but for its learner, if any; Sample's pmf
/// equals PMF exactly; the pmf sums to 1 (or less, when Sample may return nothing); positive wherever a light
/// contributes; one random number.
class LightSampler {
  public:
    virtual ~LightSampler() = default;
    virtual void Prepare(PrepareContext &) {}
    virtual std::optional<SampledLight> Sample(const LightQuery &query, Float u) const = 0;
    virtual Float PMF(const LightQuery &query, LightId light) const = 0;
    /// Null if nothing is learned after Prepare.
    virtual LightLearner *Learner() { return nullptr; }
    /// Sizes, seconds, counts: for --stats and image metadata.
    virtual void Report(nlohmann::ordered_json &) const {}
    /// What the sampler knows at a point (cell, records, ...): the same names in the same order for every query. For
    /// pictures only, may be slow.
    virtual void Inspect(const LightQuery &, std::vector<InspectedValue> &) const {}
    /// The learned structure in words and numbers, several lines; empty if there is none.
    virtual std::string DescribeStructure() const { return {}; }
};

}  // namespace pbrt
