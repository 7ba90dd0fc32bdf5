#include <algorithm>

#include "pbrt/build/integrator_builder.h"
#include "pbrt/integrators/bdpt_integrator.h"
#include "pbrt/integrators/light_path_integrator.h"
#include "pbrt/integrators/mlt_integrator.h"
#include "pbrt/integrators/sppm_integrator.h"

namespace pbrt {
namespace {

struct ShootingParams {
    std::string shootingSampler = "power";
    void Describe(auto &&v) {
        v("shootingsampler", shootingSampler,
          "light sampler of light paths, such as power or uniform; --shooting-sampler overrides it (only here)");
    }
};

struct LightPathParams : DepthParams {
    ShootingParams shooting;
    void Describe(auto &&v) {
        DepthParams::Describe(v);
        shooting.Describe(v);
    }
};

struct BidirectionalParams : LightPathParams {
    bool regularize = false;
    void Describe(auto &&v) {
        LightPathParams::Describe(v);
        v("regularize", regularize, "roughen nearly specular lobes after non-specular scattering");
    }
};

struct BdptParams : BidirectionalParams {
    LightSelectionParams lights{.lightSampler = "power"};
    bool visualizeStrategies = false, visualizeWeights = false;
    void Describe(auto &&v) {
        BidirectionalParams::Describe(v);
        v("visualizestrategies", visualizeStrategies,
          "also write each strategy's image, `<image>-strategy-depth<d>-s<s>-t<t>`; limits `maxdepth` to 5");
        v("visualizeweights", visualizeWeights,
          "also write each strategy's share, `<image>-weighted-depth<d>-s<s>-t<t>`; limits `maxdepth` to 5");
        lights.Describe(v);
    }
};

struct MltParams : BidirectionalParams {
    LightSelectionParams lights{.lightSampler = "power"};
    int bootstrapSamples = 100000, chains = 1000, mutationsPerPixel = 100;
    Float largeStepProbability = 0.3f, sigma = 0.01f;
    void Describe(auto &&v) {
        BidirectionalParams::Describe(v);
        v("bootstrapsamples", bootstrapSamples, kCounts,
          "bootstrap paths for `mutationsperpixel`; at least one per 8 mutations");
        v("chains", chains, kCounts, "Markov chains for `mutationsperpixel`; at least one per mutation");
        v("mutationsperpixel", mutationsPerPixel, kCounts, "replaces the sampler's `pixelsamples`; --spp overrides it");
        v("largestepprobability", largeStepProbability, Range<Float>{0, 1}, "probability of redrawing all numbers");
        v("sigma", sigma, kPositive, "standard deviation of small mutations, of numbers in [0, 1)");
        lights.Describe(v);
    }
};

struct SppmParams : DepthParams {
    int photonsPerIteration = -1, seed = 0;
    Float radius = 1;
    LightSelectionParams lights;
    ShootingParams shooting;
    void Describe(auto &&v) {
        DepthParams::Describe(v);
        v("photonsperiteration", photonsPerIteration, Range<int>{-1, std::numeric_limits<int>::max()},
          "light paths per iteration; -1 or 0: one per pixel");
        v("radius", radius, kPositive, "initial photon radius, in scene units");
        v("seed", seed, "seed of the light paths");
        lights.Describe(v);
        shooting.Describe(v);
    }
};

using OwnedSampler = std::unique_ptr<LightSampler>;

/// Adds an integrator whose light paths begin at lights. `read(p, reading, settings)` may change the settings and
/// returns `make(context, lights, shooting)`; `lights` is null if P has no light sampler.
template <class P, class Read>
void AddShooting(IntegratorTable &table, const char *name, const char *summary, IntegratorTraits traits, Read read) {
    traits.hasEmissionSampler = true;
    auto readAll = [read](const P &p, const ParamSet &set, const IntegratorReading &r) {
        IntegratorSettings settings;
        settings.maxDepth = p.MaxDepth(r);
        if constexpr (requires { p.adaptive; }) settings.adaptive = p.adaptive;
        constexpr bool kHasLights = requires { p.lights; };
        if constexpr (requires { p.mutationsPerPixel; }) settings.samplesPerPixel = p.mutationsPerPixel;
        if constexpr (kHasLights) settings.lights = ReadLights(set, r, P().lights);
        settings.shooting =
            ReadShootingSampler(set, p.shooting.shootingSampler, r.options.shootingSampler, r.registry, r.sink);
        if ((kHasLights && !settings.lights) || !settings.shooting) return settings;
        settings.make = [make = read(p, r, settings), &registry = r.registry, lights = settings.lights,
                         shooting = *settings.shooting](const PathContext &context,
                                                        const ColorSpace &) -> std::unique_ptr<Integrator> {
            const LightTable &all = context.scene.Lights();
            OwnedSampler sampler = lights ? lights->sampler.Make(registry, all) : nullptr;
            return make(context, std::move(sampler), shooting.Make(registry, all));
        };
        return settings;
    };
    table.Add<P>(name, summary, readAll, traits);
}

auto ReadBdpt(const BdptParams &p, const IntegratorReading &r, IntegratorSettings &settings) {
    using Kind = StrategyImages::Kind;
    std::vector<Kind> shown;
    if (p.visualizeStrategies) shown.push_back(Kind::Unweighted);
    if (p.visualizeWeights) shown.push_back(Kind::Weighted);
    if (!shown.empty() && settings.maxDepth > StrategyImages::kMaxDepth) {
        settings.maxDepth = StrategyImages::kMaxDepth;
        r.sink.Warning({}, "Integrator \"bdpt\": images of strategies go up to \"maxdepth\" {}, which is used.",
                       settings.maxDepth);
    }
    return [depth = settings.maxDepth, regularize = p.regularize, shown](const PathContext &context,
                                                                         OwnedSampler lights, OwnedSampler shooting) {
        return std::make_unique<BdptIntegrator>(
            context, depth, regularize, std::move(lights), std::move(shooting),
            shown.empty() ? nullptr : std::make_unique<StrategyImages>(shown, depth));
    };
}

auto ReadMlt(const MltParams &p, const IntegratorReading &, IntegratorSettings &settings) {
    const auto perSample = [&](int all) { return std::max(1, (all + p.mutationsPerPixel / 2) / p.mutationsPerPixel); };
    const MltSettings mlt{settings.maxDepth,   p.regularize,           perSample(p.bootstrapSamples),
                          perSample(p.chains), p.largeStepProbability, p.sigma};
    return [mlt](const PathContext &context, OwnedSampler lights, OwnedSampler shooting) {
        return std::make_unique<MltIntegrator>(context, mlt, std::move(lights), std::move(shooting));
    };
}

auto ReadSppm(const SppmParams &p, const IntegratorReading &r, IntegratorSettings &settings) {
    const SppmSettings sppm{settings.maxDepth, p.photonsPerIteration, p.radius, p.seed, r.options.sampledLightOnly};
    return [sppm](const PathContext &context, OwnedSampler lights, OwnedSampler shooting) {
        return std::make_unique<SppmIntegrator>(context, sppm, std::move(lights), std::move(shooting));
    };
}

auto ReadLightPath(const LightPathParams &, const IntegratorReading &, IntegratorSettings &settings) {
    return [depth = settings.maxDepth](const PathContext &context, OwnedSampler, OwnedSampler shooting) {
        return std::make_unique<LightPathIntegrator>(context, depth, std::move(shooting));
    };
}

}  // namespace

void AddLightPathIntegrators(IntegratorTable &t) {
    AddShooting<LightPathParams>(
        t, "lightpath",
        "also through media, but for the light that they emit; with the cameras perspective and (only here) "
        "orthographic and spherical; **differs**: the adjoint of shading normals is used (stock: #385), crop windows "
        "keep all light (stock: #347), and emitters of all shapes that the camera sees have their own radiance",
        {.connectsToCamera = true, .rendersMedia = true, .passesInterfaces = true, .samplesPixels = false},
        ReadLightPath);
    AddShooting<WithAdaptive<BdptParams>>(
        t, "bdpt",
        "with media, at most 1,000 scattering events from either side; cameras and shading normals as lightpath; "
        "only here: any light sampler for the light that a vertex of the camera's path is connected to; "
        "images of strategies are written at the end, not with checkpoints, parts or mpirun",
        {.hasLightSampler = true,
         .connectsToCamera = true,
         .rendersMedia = true,
         .passesInterfaces = true,
         .isAdaptive = true},
        ReadBdpt);
    AddShooting<MltParams>(
        t, "mlt",
        "as bdpt, with the films rgb and spectral; light samplers learn in their preparation only; **differs**: every "
        "mutation of a pixel has its share of bootstrap and chains, so that more mutations converge to the image for "
        "every seed (stock: #525); a mutation is of all connections of a pair of subpaths, not of one",
        {.hasLightSampler = true,
         .connectsToCamera = true,
         .rendersMedia = true,
         .passesInterfaces = true,
         .samplesPixels = false},
        ReadMlt);
    AddShooting<SppmParams>(
        t, "sppm",
        "surfaces only; only here: light samplers as path; **differs**: the radius shrinks with "
        "the iteration, the same in every pixel; `maxdepth` limits the whole path; an iteration has one time",
        {.hasLightSampler = true, .hasSampledLightOnly = true}, ReadSppm);
}

}  // namespace pbrt
