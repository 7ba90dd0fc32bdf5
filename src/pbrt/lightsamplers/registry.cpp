#include "pbrt/lightsamplers/registry.h"

#include "pbrt/lightsamplers/bvh_light_sampler.h"
#include "pbrt/lightsamplers/exhaustive_light_sampler.h"
#include "pbrt/lightsamplers/simple_light_samplers.h"

namespace pbrt {

std::unique_ptr<LightSampler> LightSamplerRegistry::Make(const Entry &entry, const LightTable &lights,
                                                         const ParamSet &params, bool meshLights) const {
    PBRT_CHECK(!meshLights || entry.traits.takesGroups);
    return entry.make(params, meshLights ? lights.ByLight() : lights.ByComponent());
}

std::vector<std::string> LightSamplerRegistry::EmissionSamplerNames() const {
    std::vector<std::string> names = samplers.Names();
    std::erase_if(names, [&](const std::string &name) { return !samplers.Find(name).traits.isSameEverywhere; });
    return names;
}

std::string LightSamplerRegistry::Listing() const {
    return ListingOf(samplers.Document("lightsamplers")) +
           "\n    Every sampler that has no parameter \"meshlights\" takes \"bool meshlights\" of the integrator\n"
           "    (\"+mesh\" in flags): an emissive mesh is one light; inside it a triangle is chosen by its share of "
           "the power.\n";
}

namespace {

template <class Sampler>
void AddStock(LightSamplerRegistry &registry, const char *name, const char *summary, bool isSameEverywhere) {
    auto make = [](NoParams, const ParamSet &, const LightGroups &groups) { return std::make_unique<Sampler>(groups); };
    registry.samplers.Add<NoParams>(name, summary, make,
                                    {.takesGroups = true, .isSameEverywhere = isSameEverywhere, .isStock = true});
}

}  // namespace

void RegisterStockLightSamplers(LightSamplerRegistry &registry) {
    AddStock<UniformLightSampler>(registry, "uniform", "Every light is equally likely.", true);
    AddStock<PowerLightSampler>(registry, "power", "Chooses lights in proportion to their emitted power.", true);
    AddStock<BVHLightSampler>(registry, "bvh",
                              "Walks down a tree of light bounds by distance, power and orientation; pbrt's default.",
                              false);
    AddStock<ExhaustiveLightSampler>(
        registry, "exhaustive", "Weighs every single light by distance, power and orientation; slow, for comparison.",
        false);
}

}  // namespace pbrt
