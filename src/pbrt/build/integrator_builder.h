#pragma once
#include <algorithm>
#include <functional>
#include <limits>
#include <optional>

#include "pbrt/build/built_scene.h"
#include "pbrt/build/light_sampler_spec.h"
#include "pbrt/core/factory_table.h"
#include "pbrt/integrators/pixel_integrator.h"

namespace pbrt {

/// An integrator with parsed parameters, created once the scene exists.
struct IntegratorSettings {
    std::string type;
    int maxDepth = 5;
    bool adaptive = false;
    int samplesPerPixel = 0;               ///< positive: replaces the sampler's, unless --spp or --quick overrides it
    std::optional<LightSelection> lights;  ///< for integrators with a light sampler
    std::optional<LightSamplerSpec> shooting;  ///< for integrators with light paths
    /// Call only if parsing gave no errors; the registry used must still exist.
    std::function<std::unique_ptr<Integrator>(const PathContext &, const ColorSpace &filmSpace)> make;
};

struct IntegratorReading {
    const BuildOptions &options;
    const PluginRegistry &registry;
    DiagnosticSink &sink;
    const ParamReader &before;  ///< with the light samplers' parameters declared
};

/// Capabilities and requirements of an integrator, declared at its registration.
struct IntegratorTraits {
    bool hasLightSampler = false;      ///< accepts the light samplers' parameters and flags
    bool hasEmissionSampler = false;   ///< a second light sampler selects where light paths start
    bool connectsToCamera = false;     ///< requires Camera::CanConnect
    bool isGuided = false;             ///< supports DirectionSampling
    bool rendersMedia = false;         ///< traces media
    bool passesInterfaces = false;     ///< shadow rays pass interface surfaces; geometry is built for it
    bool scattersSubsurface = false;   ///< others render subsurface materials as dielectrics
    bool isAdaptive = false;           ///< supports different numbers of samples per pixel
    bool samplesPixels = true;         ///< false: samples do not belong to pixels, as --disable-pixel-jitter requires
    bool hasSampledLightOnly = false;  ///< supports BuildOptions::sampledLightOnly
    bool hasDepth = false;             ///< has the parameter "maxdepth"; set by TraitsOf
};
using IntegratorTable = FactoryTable<IntegratorSettings, const IntegratorReading, IntegratorTraits>;
const IntegratorTable &Integrators();
/// Integrator of the format that is not supported.
inline constexpr const char *kUnsupportedIntegrator = "function";

/// Parses the parameters of the integrator named by scene or --integrator, and of its light sampler. Reports all errors
/// to the sink before anything is built.
IntegratorSettings ReadIntegrator(const Entity &entity, const BuildOptions &options, const PluginRegistry &registry,
                                  DiagnosticSink &sink);

/// Creates the integrator of a scene from settings that parsed without errors.
BuiltIntegrator MakeIntegrator(const BuiltScene &built, const IntegratorSettings &settings, DiagnosticSink &sink);

/// Integrator type: the scene's, or that of --integrator.
inline const std::string &IntegratorType(const Entity &entity, const BuildOptions &options) {
    return options.integrator.empty() ? entity.type : options.integrator;
}
/// Traits of that integrator; defaults if the name is unknown.
inline IntegratorTraits TraitsOf(const std::string &integrator) {
    if (!Integrators().Has(integrator)) return {};
    const IntegratorTable::Entry &entry = Integrators().Find(integrator);
    IntegratorTraits traits = entry.traits;
    traits.hasDepth = std::ranges::count(entry.params, "maxdepth", &ParamDoc::name) > 0;
    return traits;
}

struct AcceleratorContext {
    DiagnosticSink &sink;
};
/// The accelerator is always Embree; the parameters of stock's accelerators are validated only.
using AcceleratorTable = FactoryTable<std::monostate, const AcceleratorContext>;
const AcceleratorTable &Accelerators();

/// Adds "adaptive" to the parameters of a pixel integrator.
template <class P>
struct WithAdaptive : P {
    bool adaptive = false;
    void Describe(auto &&v) {
        P::Describe(v);
        v("adaptive", adaptive, "more samples where the image is noisier; as --adaptive (only here)");
    }
};

inline constexpr Range<int> kCounts{1, std::numeric_limits<int>::max()};
inline constexpr Range<Float> kPositive = Positive(std::numeric_limits<Float>::max());

struct DepthParams {
    int maxDepth = 5;
    void Describe(auto &&v) {
        v("maxdepth", maxDepth, Range<int>{0, std::numeric_limits<int>::max()},
          "maximum scattering events; --maxdepth overrides it");
    }
    int MaxDepth(const IntegratorReading &r) const { return r.options.maxDepth.value_or(maxDepth); }
};

/// Parses an integrator's light sampler; empty on errors, which are in the sink.
inline std::optional<LightSelection> ReadLights(const ParamSet &set, const IntegratorReading &r,
                                                const LightSelectionParams &defaults = {}) {
    const LightFlags flags{r.options.lightSampler, r.options.meshLights, r.options.lightSamplerFlag};
    return ReadLightSelection(set, flags, r.registry, r.sink, defaults);
}

/// lightpath, bdpt, mlt, sppm.
void AddLightPathIntegrators(IntegratorTable &table);

}  // namespace pbrt
