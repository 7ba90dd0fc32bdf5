#include "pbrt/lightsamplers/registry.h"

#include <stdexcept>

#include "pbrt/lightsamplers/bvh_light_sampler.h"
#include "pbrt/lightsamplers/exhaustive_light_sampler.h"
#include "pbrt/lightsamplers/simple_light_samplers.h"

namespace pbrt {

void LightSamplerRegistry::Add(Entry entry) {
    if (entry.name.empty() || !entry.make) throw std::logic_error("light sampler without a name or a factory");
    std::string name = entry.name;
    if (!entries_.emplace(name, std::move(entry)).second)
        throw std::logic_error(fmt::format("light sampler \"{}\" is registered twice", name));
}

std::vector<std::string> LightSamplerRegistry::Names() const {
    std::vector<std::string> names;
    for (const auto &[name, entry] : entries_) names.push_back(name);
    return names;
}

const LightSamplerRegistry::Entry &LightSamplerRegistry::Find(const std::string &name, const FileLoc &loc) const {
    auto it = entries_.find(name);
    if (it == entries_.end())
        throw UserError(fmt::format("\"{}\" is not a light sampler; {}.", name, ListChoices(name, Names())), loc);
    return it->second;
}

void LightSamplerRegistry::AddGate(GateEntry entry) {
    if (entry.name.empty() || !entry.make) throw std::logic_error("shadow-ray gate without a name or a factory");
    std::string name = entry.name;
    if (!gates_.emplace(name, std::move(entry)).second)
        throw std::logic_error(fmt::format("shadow-ray gate \"{}\" is registered twice", name));
}

std::vector<std::string> LightSamplerRegistry::GateNames() const {
    std::vector<std::string> names;
    for (const auto &[name, entry] : gates_) names.push_back(name);
    return names;
}

const LightSamplerRegistry::GateEntry &LightSamplerRegistry::FindGate(const std::string &name, const FileLoc &loc) const {
    auto it = gates_.find(name);
    if (it == gates_.end())
        throw UserError(gates_.empty() ? fmt::format("\"{}\": this build has no shadow-ray gates.", name)
                                       : fmt::format("\"{}\" is not a shadow-ray gate; {}.", name, ListChoices(name, GateNames())),
                        loc);
    return it->second;
}

std::unique_ptr<LightSampler> LightSamplerRegistry::Make(const Entry &entry, const LightTable &lights,
                                                         const ParamSet &params, bool meshLights) const {
    PBRT_CHECK(!meshLights || entry.takesGroups);
    return entry.make(meshLights ? lights.Wholes() : lights.Parts(), params);
}

std::string LightSamplerRegistry::Listing() const {
    std::string out;
    auto list = [&](const auto &entry) {
        out += fmt::format("{}{}\n    {}\n", out.empty() ? "" : "\n", entry.name, entry.summary);
        if (entry.params.empty()) out += "    No parameters.\n";
        for (const ParamDoc &p : entry.params)
            out += fmt::format("    {} {}.{} = {}{}\n        {}\n", p.type, entry.name, p.name, p.defaultValue,
                               p.range.empty() ? "" : fmt::format(" ({})", p.range), p.help);
    };
    for (const auto &[name, entry] : entries_) list(entry);
    out += "\n    Every sampler without a parameter \"meshlights\" of its own takes \"bool meshlights\" of the integrator\n"
               "    (\"+mesh\" in flags): an emissive mesh is one light; inside it a triangle is chosen by its share of the power.\n";
    if (!gates_.empty()) out += "\nShadow-ray gates (\"string shadowgate\" of the integrator, \"+gate=\" in flags), for every sampler:\n";
    for (const auto &[name, entry] : gates_) list(entry);
    return out;
}

namespace {

template <class Sampler>
void AddStock(LightSamplerRegistry &registry, const char *name, const char *summary) {
    LightSamplerRegistry::Entry entry;
    entry.name = name;
    entry.summary = summary;
    entry.make = [](const LightGroups &groups, const ParamSet &) { return std::make_unique<Sampler>(groups); };
    entry.takesGroups = true;
    registry.Add(std::move(entry));
}

}  // namespace

void RegisterStockLightSamplers(LightSamplerRegistry &registry) {
    AddStock<UniformLightSampler>(registry, "uniform", "Every light is equally likely.");
    AddStock<PowerLightSampler>(registry, "power", "By emitted power.");
    AddStock<BVHLightSampler>(registry, "bvh",
                              "Down a tree of light bounds by distance, power and orientation; pbrt's default.");
    AddStock<ExhaustiveLightSampler>(registry, "exhaustive",
                                     "By distance, power and orientation of every single light; slow, for comparison.");
}

}  // namespace pbrt
