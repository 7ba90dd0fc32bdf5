#pragma once
#include <memory>
#include <string>

#include "pbrt/core/factory_table.h"
#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace pbrt {

struct LightSamplerTraits {
    /// True if it chooses among the groups that it is given; other samplers have a parameter "meshlights".
    bool takesGroups = false;
    /// True if its probabilities are the same for every query: then it can choose where light paths begin.
    bool isSameEverywhere = false;
};

/// The light samplers that can be named in a scene or on the command line. An object, not a global; filled by explicit
/// calls.
class LightSamplerRegistry {
  public:
    /// The context is the set of groups to choose from, unless the sampler has a parameter "meshlights", which decides
    /// it.
    using Samplers = FactoryTable<std::unique_ptr<LightSampler>, const LightGroups, LightSamplerTraits>;
    using Entry = Samplers::Entry;

    Samplers samplers{"light sampler"};

    /// `meshLights`: an emissive mesh is one light for selection; only for entries that take groups.
    std::unique_ptr<LightSampler> Make(const Entry &entry, const LightTable &lights, const ParamSet &params,
                                       bool meshLights) const;
    /// Text of --list-lightsamplers and of docs/reference/lightsamplers.md.
    std::string Listing() const;
};

/// uniform, power, bvh, exhaustive.
void RegisterStockLightSamplers(LightSamplerRegistry &registry);

}  // namespace pbrt
