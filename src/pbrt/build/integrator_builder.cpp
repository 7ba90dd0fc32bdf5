#include "pbrt/build/integrator_builder.h"

#include <algorithm>
#include <limits>

#include "pbrt/build/collect.h"
#include "pbrt/integrators/bdpt_integrator.h"
#include "pbrt/integrators/light_path_integrator.h"
#include "pbrt/integrators/mlt_integrator.h"
#include "pbrt/integrators/path_integrator.h"
#include "pbrt/integrators/simple_integrators.h"
#include "pbrt/integrators/sppm_integrator.h"
#include "pbrt/integrators/volpath_integrator.h"

namespace pbrt {

namespace {

struct DepthParams {
    int maxDepth = 5;
    template <class V>
    void Describe(V &&v) {
        v("maxdepth", maxDepth, Range<int>{0, std::numeric_limits<int>::max()},
          "largest number of scattering events of a path; --maxdepth overrides it");
    }
    int MaxDepth(const IntegratorReading &r) const { return r.options.maxDepth.value_or(maxDepth); }
};

struct PathParams : DepthParams {
    bool regularize = false;
    LightSelectionParams lights;  ///< declared here, used by ReadLightSelection
    template <class V>
    void Describe(V &&v) {
        DepthParams::Describe(v);
        v("regularize", regularize, "roughen nearly specular lobes after the first non-specular scattering");
        lights.Describe(v);
    }
};

struct GuidedPathParams : PathParams {
    bool guide = false;
    GuideParams guideParams;
    template <class V>
    void Describe(V &&v) {
        PathParams::Describe(v);
        v("guide", guide, "let paths depend on what earlier samples found, as the parameters below say; as --guide");
        guideParams.Describe(v);
    }
};

struct VolPathParams : PathParams {
    bool equiangular = false;
    template <class V>
    void Describe(V &&v) {
        PathParams::Describe(v);
        v("equiangular", equiangular,
          "in a homogeneous medium also send a shadow ray from every segment up to the first scattering, from a place "
          "drawn for the light that was chosen (only here)");
    }
};

std::optional<LightSelection> ReadLights(const ParamSet &set, const IntegratorReading &r,
                                         const LightSelectionParams &defaults = {}) {
    const LightFlags flags{r.options.lightSampler, r.options.meshLights, r.options.shadowGate,
                           r.options.lightSamplerFlag, r.options.shadowGateFlag};
    return ReadLightSelection(set, flags, r.registry, r.sink, defaults);
}

/// The light sampler and the gate (null: none) that were chosen.
std::pair<std::unique_ptr<LightSampler>, std::unique_ptr<ShadowRayGate>> MakeLights(
    const LightSelection &chosen, const LightSamplerRegistry &registry, const LightTable &table) {
    const auto &[sampler, gate] = chosen;
    return {registry.Make(*sampler.entry, table, sampler.params, sampler.meshLights),
            gate.entry ? gate.entry->make(gate.params, table) : nullptr};
}

/// Without media volpath is path with subsurface scattering and with light sampling through interface surfaces.
IntegratorSettings MakePath(const PathParams &p, const ParamSet &set, const IntegratorReading &r, bool isVolume,
                            bool equiangular = false, std::optional<GuideParams> guide = {}) {
    IntegratorSettings settings;
    settings.maxDepth = p.MaxDepth(r);
    settings.lights = ReadLights(set, r);
    if (!settings.lights) return settings;
    PathSettings path;
    path.maxDepth = settings.maxDepth;
    path.regularize = p.regularize;
    path.seesThroughInterfaces = isVolume;
    path.equiangular = equiangular;
    path.guide = guide;
    path.sampledLightOnly = r.options.sampledLightOnly;
    settings.make = [path, isVolume, &registry = r.registry, lights = *settings.lights](
                        const PathContext &context, const ColorSpace &) -> std::unique_ptr<Integrator> {
        PathSettings mine = path;
        mine.subsurface = isVolume && context.scene.HasSubsurface();
        auto [sampler, gate] = MakeLights(lights, registry, context.scene.Lights());
        if (isVolume && context.scene.HasMedia())
            return std::make_unique<VolPathIntegrator>(context, mine, std::move(sampler), std::move(gate));
        return std::make_unique<PathIntegrator>(context, mine, std::move(sampler), std::move(gate));
    };
    return settings;
}

bool FollowsPhotons(const std::string &integrator) { return FollowsLight(integrator) || integrator == "sppm"; }

/// Where light paths begin.
struct ShootingParams {
    std::string shootingSampler = "power";
    template <class V>
    void Describe(V &&v) {
        v("shootingsampler", shootingSampler,
          "the light sampler that chooses where light paths begin, with the same probabilities everywhere: power, "
          "uniform or (where it is built) seen; --shooting-sampler overrides it (only here)");
    }
};

std::optional<LightSamplerSpec> ReadShooting(const ShootingParams &p, const ParamSet &set, const IntegratorReading &r) {
    return ReadShootingSampler(set, p.shootingSampler, r.options.shootingSampler, r.registry, r.sink);
}

std::unique_ptr<LightSampler> MakeShooting(const LightSamplerSpec &spec, const LightSamplerRegistry &registry,
                                           const PathContext &context) {
    return registry.Make(*spec.entry, context.scene.Lights(), spec.params, false);
}

struct LightPathParams : DepthParams {
    ShootingParams shooting;
    template <class V>
    void Describe(V &&v) {
        DepthParams::Describe(v);
        shooting.Describe(v);
    }
};

struct SimplePathParams : DepthParams {
    bool sampleLights = true, sampleBsdf = true;
    template <class V>
    void Describe(V &&v) {
        DepthParams::Describe(v);
        v("samplelights", sampleLights,
          "sample lights by shadow rays; false: light is found only where a path hits it");
        v("samplebsdf", sampleBsdf, "sample directions from the BSDF; false: uniformly");
    }
};

struct BidirectionalParams : LightPathParams {
    bool regularize = false;
    template <class V>
    void Describe(V &&v) {
        LightPathParams::Describe(v);
        v("regularize", regularize, "roughen nearly specular lobes after the first non-specular scattering");
    }
};

struct BdptParams : BidirectionalParams {
    LightSelectionParams lights{.lightSampler = "power"};
    bool visualizeStrategies = false, visualizeWeights = false;
    template <class V>
    void Describe(V &&v) {
        BidirectionalParams::Describe(v);
        v("visualizestrategies", visualizeStrategies,
          "also write what every strategy alone finds, `<picture>-strategy-depth<d>-s<s>-t<t>`: paths of s vertices "
          "from the light and t from the camera; limits `maxdepth` to 5");
        v("visualizeweights", visualizeWeights,
          "also write the share of every strategy in the picture, `<picture>-weighted-depth<d>-s<s>-t<t>`; limits "
          "`maxdepth` to 5");
        lights.Describe(v);
    }
};

IntegratorSettings MakeBdpt(const BdptParams &p, const ParamSet &set, const IntegratorReading &r) {
    IntegratorSettings settings;
    settings.maxDepth = p.MaxDepth(r);
    settings.lights = ReadLights(set, r, BdptParams().lights);
    settings.shooting = ReadShooting(p.shooting, set, r);
    if (!settings.lights || !settings.shooting) return settings;
    using Kind = StrategyPictures::Kind;
    std::vector<Kind> shown;
    if (p.visualizeStrategies) shown.push_back(Kind::Unweighted);
    if (p.visualizeWeights) shown.push_back(Kind::Weighted);
    if (!shown.empty() && settings.maxDepth > StrategyPictures::kMaxDepth) {
        settings.maxDepth = StrategyPictures::kMaxDepth;
        r.sink.Warning({}, fmt::format("Integrator \"bdpt\": pictures of strategies go up to \"maxdepth\" {}, which is "
                                       "used.",
                                       settings.maxDepth));
    }
    settings.make = [depth = settings.maxDepth, regularize = p.regularize, &registry = r.registry,
                     lights = *settings.lights, shooting = *settings.shooting,
                     shown](const PathContext &context, const ColorSpace &) -> std::unique_ptr<Integrator> {
        auto [sampler, gate] = MakeLights(lights, registry, context.scene.Lights());
        return std::make_unique<BdptIntegrator>(
            context, depth, regularize, std::move(sampler), std::move(gate), MakeShooting(shooting, registry, context),
            shown.empty() ? nullptr : std::make_unique<StrategyPictures>(shown, depth));
    };
    return settings;
}

struct MltParams : BidirectionalParams {
    int bootstrapSamples = 100000, chains = 1000, mutationsPerPixel = 100;
    Float largeStepProbability = 0.3f, sigma = 0.01f;
    template <class V>
    void Describe(V &&v) {
        BidirectionalParams::Describe(v);
        v("bootstrapsamples", bootstrapSamples, Range<int>{1, std::numeric_limits<int>::max()},
          "independent paths that find out how much light there is, for `mutationsperpixel`; at least one for eight "
          "mutations are traced");
        v("chains", chains, Range<int>{1, std::numeric_limits<int>::max()},
          "chains of mutations, for `mutationsperpixel`; at least one for each mutation of a pixel");
        v("mutationsperpixel", mutationsPerPixel, Range<int>{1, std::numeric_limits<int>::max()},
          "takes the place of the sampler's `pixelsamples`; --spp overrides it");
        v("largestepprobability", largeStepProbability, Range<Float>{0, 1},
          "of a mutation that draws all numbers anew");
        v("sigma", sigma, Positive(std::numeric_limits<Float>::max()),
          "standard deviation of the other mutations, of numbers in [0, 1)");
    }
};

struct SppmParams : DepthParams {
    int photonsPerIteration = -1, seed = 0;
    Float radius = 1;
    LightSelectionParams lights;
    ShootingParams shooting;
    template <class V>
    void Describe(V &&v) {
        DepthParams::Describe(v);
        v("photonsperiteration", photonsPerIteration, Range<int>{-1, std::numeric_limits<int>::max()},
          "light paths of an iteration; -1 or 0: as many as the film has pixels");
        v("radius", radius, Positive(std::numeric_limits<Float>::max()),
          "of the first iteration, in units of the scene: photons this near to a place count there");
        v("seed", seed, "chooses among sets of light paths");
        lights.Describe(v);
        shooting.Describe(v);
    }
};

IntegratorSettings MakeSppm(const SppmParams &p, const ParamSet &set, const IntegratorReading &r) {
    IntegratorSettings settings;
    settings.maxDepth = p.MaxDepth(r);
    settings.lights = ReadLights(set, r);
    settings.shooting = ReadShooting(p.shooting, set, r);
    if (!settings.lights || !settings.shooting) return settings;
    const SppmSettings sppm{settings.maxDepth, p.photonsPerIteration, p.radius, p.seed, r.options.sampledLightOnly};
    settings.make = [sppm, &registry = r.registry, lights = *settings.lights, shooting = *settings.shooting](
                        const PathContext &context, const ColorSpace &) -> std::unique_ptr<Integrator> {
        auto [sampler, gate] = MakeLights(lights, registry, context.scene.Lights());
        return std::make_unique<SppmIntegrator>(context, sppm, std::move(sampler), std::move(gate),
                                                MakeShooting(shooting, registry, context));
    };
    return settings;
}

struct AmbientOcclusionParams {
    bool cosine = true;
    Float maxDistance = Infinity;
    template <class V>
    void Describe(V &&v) {
        v("cossample", cosine, "sample directions in proportion to their cosine; false: uniformly");
        v("maxdistance", maxDistance, Positive(std::numeric_limits<Float>::max()),
          "surfaces farther away do not occlude");
    }
};

void WarnOfLightFlags(const IntegratorReading &r, const char *integrator) {
    if (!r.options.lightSampler.empty() || r.options.meshLights || !r.options.shadowGate.empty())
        r.sink.Warning({}, fmt::format("--lightsampler, --mesh-lights and --shadow-gate have no effect on integrator "
                                       "\"{}\".",
                                       integrator));
}

/// An integrator without a light sampler; `make(p, maxDepth, context, film's colour space)`.
template <class P, class F>
void AddSimple(IntegratorTable &table, const char *name, F make, const char *remark = "") {
    table.Add<P>(name, remark, [name, make](const P &p, const ParamSet &, const IntegratorReading &r) {
        WarnOfLightFlags(r, name);
        IntegratorSettings settings;
        if constexpr (std::is_base_of_v<DepthParams, P>) settings.maxDepth = p.MaxDepth(r);
        settings.make = [p, make, depth = settings.maxDepth](const PathContext &context, const ColorSpace &space) {
            return make(p, depth, context, space);
        };
        return settings;
    });
}

/// An integrator that follows light from the lights only; `make(p, maxDepth, context, shooting sampler)`.
template <class P, class F>
IntegratorSettings MakeShootingOnly(const char *name, const P &p, const ParamSet &set, const IntegratorReading &r,
                                    F make) {
    WarnOfLightFlags(r, name);
    IntegratorSettings settings;
    settings.maxDepth = p.MaxDepth(r);
    settings.shooting = ReadShooting(p.shooting, set, r);
    if (!settings.shooting) return settings;
    settings.make = [p, make, depth = settings.maxDepth, &registry = r.registry, shooting = *settings.shooting](
                        const PathContext &context, const ColorSpace &) -> std::unique_ptr<Integrator> {
        return make(p, depth, context, MakeShooting(shooting, registry, context));
    };
    return settings;
}

IntegratorSettings MakeMlt(const MltParams &mlt, const ParamSet &set, const IntegratorReading &r) {
    IntegratorSettings settings = MakeShootingOnly(
        "mlt", mlt, set, r,
        [](const MltParams &p, int depth, const PathContext &context, std::unique_ptr<LightSampler> shooting) {
            const auto share = [&](int all) {
                return std::max(1, (all + p.mutationsPerPixel / 2) / p.mutationsPerPixel);
            };
            return std::make_unique<MltIntegrator>(context,
                                                   MltSettings{depth, p.regularize, share(p.bootstrapSamples),
                                                               share(p.chains), p.largeStepProbability, p.sigma},
                                                   std::move(shooting));
        });
    settings.samplesPerPixel = mlt.mutationsPerPixel;
    return settings;
}

/// True if the scene stands in a medium without a boundary: a ray from the camera leaves the scene in one.
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
    return static_cast<bool>(medium);
}

bool HasLightsBeyondScene(const LightTable &lights) {
    for (size_t i = 0; i < lights.Size(); ++i) {
        const LightKind kind = lights[LightId(i)].Kind();
        if (kind == LightKind::Infinite || kind == LightKind::DeltaDirection) return true;
    }
    return false;
}

}  // namespace

const IntegratorTable &Integrators() {
    static const IntegratorTable table = [] {
        using Request = const IntegratorReading;
        IntegratorTable t("Integrator");
        t.Add<GuidedPathParams>(
            "path",
            "only here: `guide` ([guided-paths.md](../method/guided-paths.md)), `meshlights`, `shadowgate` and the "
            "light samplers' own parameters "
            "([lightsamplers.md](lightsamplers.md)); **differs**: an unknown light sampler is an error (stock "
            "uses bvh)",
            [](const auto &p, const ParamSet &set, Request &r) {
                const bool guides = p.guide || r.options.guide;
                return MakePath(p, set, r, false, false,
                                guides ? std::optional<GuideParams>(p.guideParams) : std::nullopt);
            });
        t.Add<VolPathParams>(
            "volpath", "as path, with media and subsurface scattering, and shadow rays pass \"interface\"",
            [](const auto &p, const ParamSet &set, Request &r) { return MakePath(p, set, r, true, p.equiangular); });
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
                               });
        t.Add<LightPathParams>(
            "lightpath",
            "also through media, but for the light that they emit; with the cameras perspective and (only here) "
            "orthographic and spherical; **differs**: the adjoint of "
            "shading normals is right (stock: #385), crop windows keep all light (stock: #347), and emitters of all "
            "shapes that the camera sees have their own brightness",
            [](const auto &p, const ParamSet &set, Request &r) {
                return MakeShootingOnly("lightpath", p, set, r,
                                        [](const LightPathParams &, int depth, const PathContext &context,
                                           std::unique_ptr<LightSampler> shooting) {
                                            return std::make_unique<LightPathIntegrator>(context, depth,
                                                                                         std::move(shooting));
                                        });
            });
        t.Add<BdptParams>(
            "bdpt",
            "with media, at most 1,000 scattering events from either side; cameras and shading normals as lightpath; "
            "only here: any light sampler and gate for the light that a vertex of the camera's path is connected to; "
            "pictures of strategies are written at the end, not with checkpoints, parts or mpirun",
            [](const auto &p, const ParamSet &set, Request &r) { return MakeBdpt(p, set, r); });
        t.Add<MltParams>(
            "mlt",
            "as bdpt, with the films rgb and spectral; **differs**: every mutation of a pixel has its share of "
            "bootstrap and chains, so that more mutations converge to the picture for every seed (stock: #525); a "
            "mutation is of all connections of a pair of subpaths, not of one",
            [](const auto &p, const ParamSet &set, Request &r) { return MakeMlt(p, set, r); });
        t.Add<SppmParams>(
            "sppm",
            "surfaces only; only here: light samplers and gates as path; **differs**: the radius shrinks with the "
            "iteration, the same in every pixel; `maxdepth` limits the whole path",
            [](const auto &p, const ParamSet &set, Request &r) { return MakeSppm(p, set, r); });
        AddSimple<AmbientOcclusionParams>(
            t, "ambientocclusion", [](const auto &p, int, const PathContext &c, const ColorSpace &space) {
                return std::make_unique<AmbientOcclusionIntegrator>(c, p.cosine, p.maxDistance, space);
            });
        return t;
    }();
    return table;
}

const std::vector<std::string> &UnsupportedIntegrators() {
    static const std::vector<std::string> names = {"function"};
    return names;
}

const std::string &IntegratorType(const Entity &entity, const BuildOptions &options) {
    return options.integrator.empty() ? entity.type : options.integrator;
}

bool FollowsLight(const std::string &integrator) {
    return integrator == "lightpath" || integrator == "bdpt" || integrator == "mlt";
}

bool SeesThroughInterfaces(const std::string &integrator) {
    return integrator == "volpath" || FollowsLight(integrator);
}

bool RendersMedia(const std::string &integrator) {
    return integrator == "simplevolpath" || SeesThroughInterfaces(integrator);
}

IntegratorSettings ReadIntegrator(const Entity &entity, const BuildOptions &options,
                                  const LightSamplerRegistry &registry, DiagnosticSink &sink) {
    const std::string &type = IntegratorType(entity, options);
    const std::vector<std::string> &later = UnsupportedIntegrators();
    IntegratorSettings settings;
    if (!Integrators().Has(type)) {
        const bool isLater = std::find(later.begin(), later.end(), type) != later.end();
        sink.Error(options.integrator.empty() ? entity.loc : FileLoc{},
                   fmt::format("Integrator \"{}\" is {}; {}.", type, isLater ? "not supported yet" : "unknown",
                               ListChoices(type, Integrators().Names())));
    } else {
        // With --integrator the scene's parameters, which belong to another integrator, are ignored, except for the
        // depth.
        ParamSet fresh(fmt::format("Integrator \"{}\"", options.integrator), {});
        if (const Param *depth = entity.params.Find("maxdepth", ParamType::Integer);
            depth && type != "ambientocclusion")
            fresh.Add(*depth);
        const ParamSet &params = type != entity.type ? fresh : entity.params;
        if (!options.shootingSampler.empty() && !FollowsPhotons(type))
            sink.Error({}, fmt::format("--shooting-sampler: light paths begin at lights with the integrators "
                                       "\"bdpt\", \"lightpath\", \"mlt\" and \"sppm\" only; this one is \"{}\".",
                                       type));
        if (options.guide && type != "path")
            sink.Error({}, fmt::format("--guide: only integrator \"path\" is guided; this one is \"{}\".", type));
        ParamReader before(params);
        if (type == "path" || type == "volpath" || FollowsPhotons(type)) DeclareLightParams(before, registry);
        Collect(sink, [&] {
            settings = Integrators().Make(type, params, IntegratorReading{options, registry, sink, before});
        });
    }
    settings.type = type;
    return settings;
}

BuiltIntegrator MakeIntegrator(const IntegratorSettings &settings, const PathContext &context,
                               const ColorSpace &filmSpace, DiagnosticSink &sink) {
    if (FollowsLight(settings.type) && !context.camera.CanConnect())
        sink.Error({}, fmt::format("Integrator \"{}\" follows light to the camera, which works with the cameras "
                                   "\"perspective\", \"orthographic\" and \"spherical\" only.",
                                   settings.type));
    if (FollowsLight(settings.type) && HasLightsBeyondScene(context.scene.Lights()) && IsInEndlessMedium(context))
        sink.Warning({},
                     fmt::format("the scene stands in a medium without a boundary, and lights shine from beyond it. "
                                 "How much of their light arrives is not defined: integrator \"{}\" differs from "
                                 "\"volpath\" there. Put a shape with material \"interface\" around the medium.",
                                 settings.type));
    BuiltIntegrator built;
    built.name = settings.type;
    built.maxDepth = settings.maxDepth;
    built.integrator = settings.make(context, filmSpace);
    if (settings.lights) {
        built.lightSamplerName = settings.lights->sampler.Label();
        built.shadowGateName = settings.lights->gate.entry ? settings.lights->gate.entry->name : "";
    }
    if (settings.shooting) built.shootingSamplerName = settings.shooting->Label();
    if (settings.type != "volpath" && context.scene.HasSubsurface())
        sink.Warning(
            {},
            fmt::format("subsurface materials are plain dielectrics to integrator \"{}\"; \"volpath\" scatters light "
                        "below their surfaces.",
                        settings.type));
    return built;
}

}  // namespace pbrt
