#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/core/state_io.h"
#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {
using namespace pbrt;

/// A way to divide skies into parts, one of which gets the shadow ray.
class SkyParts {
  public:
    /// At most so many skies are divided.
    static constexpr size_t kMaxSkies = 4;
    virtual ~SkyParts() = default;

    virtual size_t Count() const = 0;
    virtual LightId Sky(size_t k) const = 0;
    /// All parts of sky k that may be chosen somewhere.
    virtual std::vector<LightId> PartsOf(size_t k) const = 0;

    /// What is known of the skies at a vertex. Of each sky the sums over its parts, for the choice among skies and
    /// lamps: of G, the light that would arrive unoccluded, and of the weights.
    struct Weights {
        Float g[kMaxSkies], w[kMaxSkies];
    };
    virtual const Weights *Weigh(const LightQuery &query, LightMemory &memory) const = 0;
    /// A part of sky k, or the whole, and its probability given the sky. `u`: uniform on the unit square; what is left
    /// of it for the point in the part is uniform again.
    virtual std::optional<SampledLight> Sample(const Weights &weights, size_t k, Point2 *u) const = 0;
    /// `light`: a part of sky k, or the whole.
    virtual Float PMF(const Weights &weights, size_t k, LightId light) const = 0;
    /// See LightDistribution::PartTowards.
    virtual LightId PartTowards(const Weights &weights, size_t k, const Point3 &p, const Vector3 &d) const = 0;

    /// `goesOn`: see LightSampler::SaveLearned.
    virtual void Save(StateWriter &writer, bool goesOn) const = 0;
    virtual void Load(StateReader &reader) = 0;

    virtual void Report(nlohmann::ordered_json &report) const = 0;
    /// What is known at the point.
    virtual void Inspect(const Point3 &p, std::vector<InspectedValue> &values) const = 0;
    /// What was learned, as lines of text.
    virtual std::string Describe() const = 0;
    virtual size_t Bytes() const = 0;
};

/// A ray towards a sky, and whether it left the scene.
struct SkyLook {
    Point3 p;
    Vector3 d;
    bool left;
};

}  // namespace ext
