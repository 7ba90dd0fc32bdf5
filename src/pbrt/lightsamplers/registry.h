#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "pbrt/core/describe.h"
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/lightsamplers/shadow_ray_gate.h"
#include "pbrt/lights/light_table.h"

namespace pbrt {

/// The samplers that can be named in a scene or on the command line. An object, not a global; filled by explicit calls.
class LightSamplerRegistry {
  public:
    /// Reads "name.key" parameters. `groups`: what is chosen among, unless a parameter of the sampler's own says it.
    using Factory = std::function<std::unique_ptr<LightSampler>(const LightGroups &groups, const ParamSet &)>;
    struct Entry {
        std::string name, summary;
        std::vector<ParamDoc> params;   ///< names without the sampler's prefix
        Factory make;
        /// Throws UserError if a parameter is out of range, as `make` would; may be left out.
        std::function<void(const ParamSet &)> check;
        /// It chooses among the groups that it is given; others have a parameter "meshlights".
        bool takesGroups = false;
    };

    struct GateEntry {
        std::string name, summary;
        std::vector<ParamDoc> params;   ///< names without the gate's prefix
        std::function<std::unique_ptr<ShadowRayGate>(const LightTable &, const ParamSet &)> make;
        std::function<void(const ParamSet &)> check;  ///< as a sampler's
    };

    void Add(Entry entry);  ///< a name used twice is our error
    std::vector<std::string> Names() const;
    const Entry &Find(const std::string &name, const FileLoc &loc = {}) const;  ///< unknown: UserError with the names
    /// `meshLights`: an emissive mesh is one light for selection; only for entries that take groups.
    std::unique_ptr<LightSampler> Make(const Entry &entry, const LightTable &lights, const ParamSet &params,
                                       bool meshLights) const;
    /// Shadow-ray gates have names of their own; a gate may share its name (and parameters' prefix) with a sampler.
    void AddGate(GateEntry entry);
    std::vector<std::string> GateNames() const;
    const GateEntry &FindGate(const std::string &name, const FileLoc &loc = {}) const;

    /// Text of --list-lightsamplers and of docs/lightsamplers.md.
    std::string Listing() const;

  private:
    std::map<std::string, Entry> entries_;
    std::map<std::string, GateEntry> gates_;
};

/// uniform, power, bvh, exhaustive.
void RegisterStockLightSamplers(LightSamplerRegistry &registry);

}  // namespace pbrt
