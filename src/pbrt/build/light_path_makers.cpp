#include <algorithm>

#include "pbrt/build/integrator_makers.h"
#include "pbrt/integrators/bdpt_integrator.h"
#include "pbrt/integrators/light_path_integrator.h"
#include "pbrt/integrators/mlt_integrator.h"
#include "pbrt/integrators/sppm_integrator.h"

namespace pbrt {

namespace {

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

std::unique_ptr<LightSampler> MakeShooting(const LightSamplerSpec &spec, const PluginRegistry &registry,
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
                     lights = settings.lights->sampler, shooting = *settings.shooting,
                     shown](const PathContext &context, const ColorSpace &) -> std::unique_ptr<Integrator> {
        auto sampler = MakeLights(lights, registry, context.scene.Lights());
        return std::make_unique<BdptIntegrator>(
            context, depth, regularize, std::move(sampler), MakeShooting(shooting, registry, context),
            shown.empty() ? nullptr : std::make_unique<StrategyPictures>(shown, depth));
    };
    return settings;
}

struct MltParams : BidirectionalParams {
    LightSelectionParams lights{.lightSampler = "power"};
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
        lights.Describe(v);
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
    settings.make = [sppm, &registry = r.registry, lights = settings.lights->sampler, shooting = *settings.shooting](
                        const PathContext &context, const ColorSpace &) -> std::unique_ptr<Integrator> {
        auto sampler = MakeLights(lights, registry, context.scene.Lights());
        return std::make_unique<SppmIntegrator>(context, sppm, std::move(sampler),
                                                MakeShooting(shooting, registry, context));
    };
    return settings;
}

IntegratorSettings MakeLightPath(const LightPathParams &p, const ParamSet &set, const IntegratorReading &r) {
    IntegratorSettings settings;
    settings.maxDepth = p.MaxDepth(r);
    settings.shooting = ReadShooting(p.shooting, set, r);
    if (!settings.shooting) return settings;
    settings.make = [depth = settings.maxDepth, &registry = r.registry, shooting = *settings.shooting](
                        const PathContext &context, const ColorSpace &) -> std::unique_ptr<Integrator> {
        return std::make_unique<LightPathIntegrator>(context, depth, MakeShooting(shooting, registry, context));
    };
    return settings;
}

IntegratorSettings MakeMlt(const MltParams &p, const ParamSet &set, const IntegratorReading &r) {
    IntegratorSettings settings;
    settings.maxDepth = p.MaxDepth(r);
    settings.samplesPerPixel = p.mutationsPerPixel;
    settings.lights = ReadLights(set, r, MltParams().lights);
    settings.shooting = ReadShooting(p.shooting, set, r);
    if (!settings.lights || !settings.shooting) return settings;
    const auto perSample = [&](int all) { return std::max(1, (all + p.mutationsPerPixel / 2) / p.mutationsPerPixel); };
    const MltSettings mlt{settings.maxDepth,   p.regularize,           perSample(p.bootstrapSamples),
                          perSample(p.chains), p.largeStepProbability, p.sigma};
    settings.make = [mlt, &registry = r.registry, lights = settings.lights->sampler, shooting = *settings.shooting](
                        const PathContext &context, const ColorSpace &) -> std::unique_ptr<Integrator> {
        auto sampler = MakeLights(lights, registry, context.scene.Lights());
        return std::make_unique<MltIntegrator>(context, mlt, std::move(sampler),
                                               MakeShooting(shooting, registry, context));
    };
    return settings;
}

}  // namespace

void AddLightPathIntegrators(IntegratorTable &t) {
    using Request = const IntegratorReading;
    t.Add<LightPathParams>(
        "lightpath",
        "also through media, but for the light that they emit; with the cameras perspective and (only here) "
        "orthographic and spherical; **differs**: the adjoint of "
        "shading normals is right (stock: #385), crop windows keep all light (stock: #347), and emitters of all "
        "shapes that the camera sees have their own brightness",
        [](const auto &p, const ParamSet &set, Request &r) { return MakeLightPath(p, set, r); },
        {.hasEmissionSampler = true,
         .connectsToCamera = true,
         .rendersMedia = true,
         .passesInterfaces = true,
         .samplesPixels = false});
    t.Add<BdptParams>(
        "bdpt",
        "with media, at most 1,000 scattering events from either side; cameras and shading normals as lightpath; "
        "only here: any light sampler for the light that a vertex of the camera's path is connected to; "
        "pictures of strategies are written at the end, not with checkpoints, parts or mpirun",
        [](const auto &p, const ParamSet &set, Request &r) { return MakeBdpt(p, set, r); },
        {.hasLightSampler = true,
         .hasEmissionSampler = true,
         .connectsToCamera = true,
         .rendersMedia = true,
         .passesInterfaces = true});
    t.Add<MltParams>(
        "mlt",
        "as bdpt, with the films rgb and spectral; light samplers learn in their preparation only; **differs**: every "
        "mutation of a pixel has its share of "
        "bootstrap and chains, so that more mutations converge to the picture for every seed (stock: #525); a "
        "mutation is of all connections of a pair of subpaths, not of one",
        [](const auto &p, const ParamSet &set, Request &r) { return MakeMlt(p, set, r); },
        {.hasLightSampler = true,
         .hasEmissionSampler = true,
         .connectsToCamera = true,
         .rendersMedia = true,
         .passesInterfaces = true,
         .samplesPixels = false});
    t.Add<SppmParams>("sppm",
                      "surfaces only; only here: light samplers as path; **differs**: the radius shrinks with the "
                      "iteration, the same in every pixel; `maxdepth` limits the whole path",
                      [](const auto &p, const ParamSet &set, Request &r) { return MakeSppm(p, set, r); },
                      {.hasLightSampler = true, .hasEmissionSampler = true});
}

}  // namespace pbrt
