#include "pbrt/build/integrator_builder.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "pbrt/build/collect.h"
#include "pbrt/integrators/path_integrator.h"
#include "pbrt/integrators/simple_integrators.h"

namespace pbrt {

namespace {

struct PathParams : DepthParams {
    bool regularize = false;
    Float minContinuation = 0;
    LightSelectionParams lights;  ///< declared here, used by ReadLightSelection
    bool guide = false;
    void Describe(auto &&v) {
        DepthParams::Describe(v);
        v("regularize", regularize, "roughen nearly specular lobes after non-specular scattering");
        v("minsurvival", minContinuation, Range<Float>{0, 1},
          "minimum continuation probability; 0: as stock, 1: no roulette (only here)");
        lights.Describe(v);
        v("guide", guide, "path guiding and learned Russian roulette; as --guide");
    }
};

/// Without media, volpath is path with subsurface scattering and shadow rays through interfaces.
IntegratorSettings MakePath(const WithAdaptive<PathParams> &p, const ParamSet &set, const IntegratorReading &r,
                            bool isVolume) {
    IntegratorSettings settings;
    settings.adaptive = p.adaptive;
    settings.maxDepth = p.MaxDepth(r);
    settings.lights = ReadLights(set, r);
    if (!settings.lights) return settings;
    PathSettings path;
    path.maxDepth = settings.maxDepth;
    path.regularize = p.regularize;
    path.minContinuation = p.minContinuation;
    path.passesInterfaces = isVolume;
    DirectionSpec directions;
    const bool isGuided = p.guide || r.options.guide || settings.lights->guide;
    // Parameters are validated even without guiding.
    if (isGuided || !r.registry.directionSamplings.Names().empty())
        directions = ReadDirections(set, settings.lights->guide, r.registry, r.sink);
    // Roulette acts from the third vertex on.
    if (!isGuided && (path.maxDepth <= 2 || path.minContinuation > 0)) directions.entry = nullptr;
    path.sampledLightOnly = r.options.sampledLightOnly;
    settings.make = [path, isVolume, isGuided, directions, &registry = r.registry, lights = settings.lights->sampler](
                        const PathContext &context, const ColorSpace &) -> std::unique_ptr<Integrator> {
        const Scene &scene = context.scene;
        PathSettings mine = path;
        mine.subsurface = isVolume && scene.HasSubsurface();
        mine.tracksMedia = isVolume && scene.HasMedia();
        std::unique_ptr<LightSampler> sampler = lights.Make(registry, scene.Lights());
        std::unique_ptr<DirectionSampling> learned;
        if (directions.entry && (isGuided || sampler->LearnsRoulette()))
            learned = directions.entry->make(directions.params, DirectionRequest{isGuided});
        return std::make_unique<PathIntegrator>(context, mine, std::move(sampler), std::move(learned));
    };
    return settings;
}

struct SimplePathParams : DepthParams {
    bool sampleLights = true, sampleBsdf = true;
    void Describe(auto &&v) {
        DepthParams::Describe(v);
        v("samplelights", sampleLights, "sample lights with shadow rays");
        v("samplebsdf", sampleBsdf, "sample the BSDF; false: uniform directions");
    }
};

struct AmbientOcclusionParams {
    bool cosine = true;
    Float maxDistance = Infinity;
    void Describe(auto &&v) {
        v("cossample", cosine, "cosine-weighted directions; false: uniform");
        v("maxdistance", maxDistance, kPositive, "maximum distance of occluders");
    }
};

/// Integrator without light sampler; `make(p, maxDepth, context, film's colour space)`.
template <class P, class F>
void AddSimple(IntegratorTable &table, const char *name, F make, IntegratorTraits traits = {}) {
    const auto read = [make](const WithAdaptive<P> &p, const ParamSet &, const IntegratorReading &r) {
        IntegratorSettings settings;
        settings.adaptive = p.adaptive;
        if constexpr (std::is_base_of_v<DepthParams, P>) settings.maxDepth = p.MaxDepth(r);
        settings.make = [p, make, depth = settings.maxDepth](const PathContext &context, const ColorSpace &space) {
            return make(p, depth, context, space);
        };
        return settings;
    };
    traits.isAdaptive = true;
    table.Add<WithAdaptive<P>>(name, "", read, traits);
}

/// Integrators with a trait: `"path" and "volpath"`.
std::string NamesWith(bool IntegratorTraits::*trait) {
    std::vector<std::string> names;
    for (const std::string &name : Integrators().Names())
        if (TraitsOf(name).*trait) names.push_back('"' + name + '"');
    const std::string last = names.back();
    names.pop_back();
    return fmt::format("{} and {}", fmt::join(names, ", "), last);
}

/// Error if a flag or suffix is given that this integrator does not use.
struct IntegratorFlag {
    std::string name;
    bool isGiven = false;
    bool IntegratorTraits::*needs = nullptr;
    FileLoc loc{};

    void Check(const std::string &integrator, DiagnosticSink &sink) const {
        if (isGiven && !(TraitsOf(integrator).*needs))
            sink.Error(loc, "{} has no effect on integrator \"{}\"; valid here: {}.", name, integrator,
                       NamesWith(needs));
    }
};

void CheckFlags(const BuildOptions &o, const std::string &integrator, DiagnosticSink &sink) {
    using Traits = IntegratorTraits;
    const IntegratorFlag flags[] = {{"--shooting-sampler", !o.shootingSampler.empty(), &Traits::hasEmissionSampler},
                                    {"--guide", o.guide, &Traits::isGuided},
                                    {"--adaptive or --noise", o.adaptive, &Traits::isAdaptive},
                                    {"--maxdepth", o.maxDepth.has_value(), &Traits::hasDepth},
                                    {"--disable-pixel-jitter", o.disablePixelJitter, &Traits::samplesPixels},
                                    {"--sampled-light", o.sampledLightOnly, &Traits::hasSampledLightOnly}};
    for (const IntegratorFlag &flag : flags) flag.Check(integrator, sink);
}

/// True if the scene is inside an unbounded medium: a camera ray leaves the scene in one.
bool IsInEndlessMedium(const PathContext &context) {
    CameraSample middle;
    middle.pFilm = middle.pLens = Point2(0.5f, 0.5f);
    const std::optional<CameraRay> start = context.camera.GenerateRay(middle, SampledWavelengths());
    if (!start) return false;
    Ray ray = start->ray;
    ray.medium = context.scene.CameraMedium();
    MediumId medium = ray.medium;
    Float t = 0;
    while (const std::optional<Scene::Interface> next = context.scene.NextInterface(ray, t)) {
        t = next->t;
        medium = next->behind;
    }
    return bool(medium);
}

/// Where the integrator is chosen: the flag or the directive.
FileLoc LocOf(const Entity &entity, const BuildOptions &options) {
    if (options.integrator.empty()) return entity.loc;
    return {std::make_shared<SourceFile>(SourceFile{"--integrator", options.integrator}), 1, 0};
}

bool HasLightsBeyondScene(const LightTable &lights) {
    for (size_t i = 0; i < lights.Size(); ++i) {
        const LightKind kind = lights[LightId(i)].Kind();
        if (kind == LightKind::Infinite || kind == LightKind::DeltaDirection) return true;
    }
    return false;
}

void WarnOfLostLightPaths(const BuiltScene &scene, const std::string &integrator, DiagnosticSink &sink) {
    const IntegratorTraits traits = TraitsOf(integrator);
    // bdpt and mlt have paths from the camera as well.
    if (!traits.hasEmissionSampler || (traits.hasLightSampler && traits.connectsToCamera)) return;
    if (const std::optional<LightId> far = scene.scene->Lights().FirstTooFarForLightPaths())
        sink.Warning(
            {},
            "light paths from {} miss the scene, as it is too far away: with integrator \"{}\" the image lacks "
            "what they would carry. A light \"distant\" has no such limit.",
            scene.lightNames.NameOf(*far), integrator);
}

}  // namespace

const IntegratorTable &Integrators() {
    static const IntegratorTable table("Integrator", [](IntegratorTable &t) {
        t.Add<WithAdaptive<PathParams>>(
            "path",
            "only here: `guide` ([guided-paths.md](../method/guided-paths.md)), `meshlights` and the light samplers' "
            "own parameters ([lightsamplers.md](lightsamplers.md)); **differs**: an unknown light sampler is an error "
            "(stock uses bvh)",
            [](const auto &p, const ParamSet &set, auto &r) { return MakePath(p, set, r, false); },
            {.hasLightSampler = true, .isGuided = true, .isAdaptive = true, .hasSampledLightOnly = true});
        t.Add<WithAdaptive<PathParams>>(
            "volpath", "as path, with media and subsurface scattering, and shadow rays pass \"interface\"",
            [](const auto &p, const ParamSet &set, auto &r) { return MakePath(p, set, r, true); },
            {.hasLightSampler = true,
             .isGuided = true,
             .rendersMedia = true,
             .passesInterfaces = true,
             .scattersSubsurface = true,
             .isAdaptive = true,
             .hasSampledLightOnly = true});
        AddSimple<SimplePathParams>(
            t, "simplepath", [](const auto &p, int depth, const PathContext &c, const ColorSpace &) {
                return std::make_unique<SimplePathIntegrator>(c, depth, p.sampleLights, p.sampleBsdf);
            });
        AddSimple<DepthParams>(t, "randomwalk", [](const auto &, int depth, const PathContext &c, const ColorSpace &) {
            return std::make_unique<RandomWalkIntegrator>(c, depth);
        });
        AddSimple<DepthParams>(t, "simplevolpath",
                               [](const auto &, int depth, const PathContext &c, const ColorSpace &) {
                                   return std::make_unique<SimpleVolPathIntegrator>(c, depth);
                               },
                               {.rendersMedia = true});
        AddLightPathIntegrators(t);
        AddSimple<AmbientOcclusionParams>(
            t, "ambientocclusion", [](const auto &p, int, const PathContext &c, const ColorSpace &space) {
                return std::make_unique<AmbientOcclusionIntegrator>(c, p.cosine, p.maxDistance, space);
            });
    });
    return table;
}

IntegratorSettings ReadIntegrator(const Entity &entity, const BuildOptions &options, const PluginRegistry &registry,
                                  DiagnosticSink &sink) {
    const std::string &type = IntegratorType(entity, options);
    IntegratorSettings settings;
    if (!Integrators().Has(type)) {
        sink.Error(LocOf(entity, options), "Integrator \"{}\" is {}; {}{}.", type,
                   type == kUnsupportedIntegrator ? "not supported yet" : "unknown", OldNameHint("Integrator", type),
                   ListChoices(type, Integrators().Names()));
    } else {
        const IntegratorTable::Entry &entry = Integrators().Find(type);
        const IntegratorTraits traits = TraitsOf(type);
        // --integrator ignores the scene's integrator parameters except the depth.
        ParamSet fresh(fmt::format("Integrator \"{}\"", options.integrator), {});
        if (const Param *depth = entity.params.Find("maxdepth", ParamType::Integer); depth && traits.hasDepth)
            fresh.Add(*depth);
        const ParamSet &params = type != entity.type ? fresh : entity.params;
        CheckFlags(options, type, sink);
        ParamReader before(params);
        if (traits.hasLightSampler || traits.hasEmissionSampler) DeclareLightParams(before, registry, traits.isGuided);
        Collect(sink, [&] {
            settings = entry.make(params, IntegratorReading{options, registry, sink, before});
            if (!traits.hasLightSampler && (!options.lightSampler.empty() || options.meshLights))
                sink.Warning({}, "--lightsampler and --mesh-lights have no effect on integrator \"{}\".", type);
        });
        if (settings.lights && settings.lights->guide) {
            const IntegratorFlag guide{"\"+guide\"", true, &IntegratorTraits::isGuided, settings.lights->guide->Loc()};
            guide.Check(type, sink);
        }
    }
    settings.type = type;
    settings.adaptive = settings.adaptive || options.adaptive;
    return settings;
}

BuiltIntegrator MakeIntegrator(const BuiltScene &scene, const IntegratorSettings &settings, DiagnosticSink &sink) {
    const PathContext context{*scene.scene, *scene.camera, scene.samplesPerPixel,
                              scene.integratorRequest.needsFootprints};
    const IntegratorTraits traits = TraitsOf(settings.type);
    if (traits.connectsToCamera && !context.camera.CanConnect())
        sink.Error(LocOf(scene.integratorRequest.entity, scene.integratorRequest.options),
                   "Integrator \"{}\" follows light to the camera, which works with the cameras "
                   "\"perspective\", \"orthographic\" and \"spherical\" only.",
                   settings.type);
    if (traits.connectsToCamera && HasLightsBeyondScene(context.scene.Lights()) && IsInEndlessMedium(context))
        sink.Warning({},
                     "the scene stands in a medium without a boundary, and lights shine from beyond it. "
                     "How much of their light arrives is not defined: integrator \"{}\" differs from "
                     "\"volpath\" there. Put a shape with material \"interface\" around the medium.",
                     settings.type);
    WarnOfLostLightPaths(scene, settings.type, sink);
    BuiltIntegrator built;
    built.integratorName = settings.type;
    built.maxDepth = settings.maxDepth;
    built.integrator = settings.make(context, scene.film->OutputSpace());
    if (settings.lights) built.lightSamplerName = settings.lights->sampler.Label();
    if (settings.shooting) built.shootingSamplerName = settings.shooting->Label();
    if (!traits.scattersSubsurface && context.scene.HasSubsurface())
        sink.Warning({},
                     "subsurface materials are plain dielectrics to integrator \"{}\"; \"volpath\" scatters light "
                     "below their surfaces.",
                     settings.type);
    return built;
}

}  // namespace pbrt
