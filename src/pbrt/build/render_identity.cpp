#include "pbrt/build/built_scene.h"

#include <fmt/ranges.h>

#include "pbrt/core/version.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "pbrt/scenefile/content_hash.h"

namespace pbrt {
namespace {

/// Output file names in the scene.
std::set<std::string> OutputsOf(const SceneDescription &d) {
    std::set<std::string> outputs;
    if (const Param *name = d.film.params.Find("filename", ParamType::String))
        outputs.insert(name->strings.begin(), name->strings.end());
    if (d.options.mseReferenceOut) outputs.insert(*d.options.mseReferenceOut);
    if (d.options.mseReferenceImage) outputs.insert(*d.options.mseReferenceImage);  // read, but no sample depends on it
    return outputs;
}

/// Bitwise hash of a group's power, position and directions.
uint64_t HashOf(const LightCandidate &c) {
    uint64_t hash = Hash(c.power, int(c.infinite), int(c.bounds.has_value()));
    if (const auto &b = c.bounds)
        hash = Hash(hash, b->bounds.low, b->bounds.high, b->w, b->phi, b->cosTheta_o, b->cosTheta_e, int(b->twoSided));
    return hash;
}

/// Hash of the radiance from outside the scene in many directions.
uint64_t HashOfEnvironments(const Scene &scene) {
    constexpr int kSide = 32;
    uint64_t hash = 0;
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    for (int i = 0; i < kSide * kSide; ++i) {
        const Point2 u((Float(i % kSide) + 0.5f) / kSide, (Float(i / kSide) + 0.5f) / kSide);
        const Vector3 d = SampleUniformSphere(u);
        scene.Lights().ForEachInfiniteEmission(scene.Bounds().Center(), d, lambda,
                                               [&](const SampledSpectrum &L, LightId id) {
                                                   for (int k = 0; k < SpectrumSamples; ++k)
                                                       hash = Hash(hash, id.value, L[k]);
                                               });
    }
    return hash;
}

}  // namespace

RenderIdentity IdentityOf(const BuildOptions &o, const std::vector<std::string> &sceneFiles,
                          const SceneDescription &description) {
    RenderIdentity identity;
    identity["program"] = BuildId();
    for (const std::string &file : sceneFiles) {
        if (file == "-") throw UserError("a scene from standard input has no checkpoints; write it to a file.");
        for (const auto &[name, hash] : FileHashes(file, OutputsOf(description))) identity["file " + name] = hash;
    }
    const auto flag = [&](const char *name, const std::string &value) {
        if (!value.empty()) identity[name] = value;
    };
    const auto whether = [&](const char *name, bool given) {
        if (given) identity[name] = "";
    };
    if (const auto &c = o.film.cropWindow)
        flag("--cropwindow", fmt::format("{},{},{},{}", c->low.x, c->high.x, c->low.y, c->high.y));
    if (const auto &b = o.film.pixelBounds)
        flag("--pixelbounds", fmt::format("{},{},{},{}", b->low.x, b->high.x, b->low.y, b->high.y));
    flag("--aov", fmt::format("{}", fmt::join(o.film.aovs, ",")));
    if (o.seed) flag("--seed", std::to_string(*o.seed));
    whether("--quick", o.quick);
    whether("--ignore-media", o.ignoreMedia);
    whether("--ignore-unsupported", o.ignoreUnsupported);
    flag("--integrator", o.integrator);
    if (o.maxDepth) flag("--maxdepth", std::to_string(*o.maxDepth));
    whether("--guide", o.guide);
    whether("--adaptive", o.adaptive);
    flag("--lightsampler", o.lightSampler);
    whether("--mesh-lights", o.meshLights);
    flag("--shooting-sampler", o.shootingSampler);
    if (o.displacementEdgeScale) flag("--displacement-edge-scale", fmt::format("{}", *o.displacementEdgeScale));
    flag("--render-coord-sys", o.renderCoordSys);
    whether("--disable-texture-filtering", o.disableTextureFiltering);
    whether("--force-diffuse", o.forceDiffuse);
    whether("--disable-pixel-jitter", o.disablePixelJitter);
    whether("--disable-wavelength-jitter", o.disableWavelengthJitter);
    return identity;
}

RenderIdentity LightIdentity(const Scene &scene, const std::string &lightSampler, const std::string &parameters) {
    RenderIdentity identity;
    identity["program"] = BuildId();
    identity["the light sampler"] = lightSampler;
    identity["the light sampler's parameters"] = parameters;
    const Bounds3 &b = scene.Bounds();
    identity["the scene's bounding box"] =
        fmt::format("({}, {}, {}) to ({}, {}, {})", b.low.x, b.low.y, b.low.z, b.high.x, b.high.y, b.high.z);
    const LightTable &lights = scene.Lights();
    identity["the number of lights"] = std::to_string(lights.LightCount());
    identity["the number of light components"] = std::to_string(lights.Size());
    uint64_t power = Hash(lights.Unit());
    for (uint32_t g = 0; g < lights.ByComponent().Size(); ++g)
        power = Hash(power, HashOf(lights.ByComponent().Candidate(g)));
    identity["the hash of the lights' power and places"] = fmt::format("{:016x}", power);
    identity["the hash of the environment lights"] = fmt::format("{:016x}", HashOfEnvironments(scene));
    return identity;
}

}  // namespace pbrt
