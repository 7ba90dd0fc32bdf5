#pragma once
#include <memory>
#include <string>

#include "pbrt/core/factory_table.h"
#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace pbrt {

struct LightSamplerTraits {
    /// True if it selects among given groups; other samplers have a parameter "meshlights".
    bool takesGroups = false;
    /// True if its probabilities do not depend on the query, so it can select where light paths start.
    bool isSameEverywhere = false;
    bool isStock = false;  ///< stock pbrt-v4 has it
    /// True if it measures what selection could reach, at any cost.
    bool isInstrument = false;
    /// "key=value,..." of an example in the help text; null: none.
    const char *example = nullptr;
};

/// Light samplers by name, for scenes and the command line. An object filled by explicit calls, not a global.
class LightSamplerRegistry {
  public:
    /// The context is the set of groups, unless the sampler has a parameter "meshlights", which determines it.
    using Samplers = FactoryTable<std::unique_ptr<LightSampler>, const LightGroups, LightSamplerTraits>;
    using Entry = Samplers::Entry;

    Samplers samplers{"light sampler"};

    /// Adds a sampler that is constructed from the scene's lights and its parameters P.
    template <class Sampler, class P>
    void Add(const char *name, const char *summary, LightSamplerTraits traits = {}) {
        const auto make = [](const P &p, const ParamSet &, const LightGroups &groups) {
            return std::make_unique<Sampler>(groups.Lights(), p);
        };
        samplers.Add<P>(name, summary, make, traits);
    }
    /// `meshLights`: an emissive mesh is one light for selection; only for entries that take groups.
    std::unique_ptr<LightSampler> Make(const Entry &entry, const LightTable &lights, const ParamSet &params,
                                       bool meshLights) const;
    /// Samplers that can select where light paths start.
    std::vector<std::string> EmissionSamplerNames() const;
    /// Text of --list-lightsamplers.
    std::string Listing() const;
};

/// uniform, power, bvh, exhaustive.
void RegisterStockLightSamplers(LightSamplerRegistry &registry);

}  // namespace pbrt
