#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pbrt/build/build_options.h"
#include "pbrt/build/memory_estimate.h"
#include "pbrt/integrators/registry.h"
#include "pbrt/integrators/render_loop.h"
#include "pbrt/lights/light_names.h"
#include "pbrt/scene/scene.h"
#include "pbrt/scenefile/scene_description.h"
#include "pbrt/textures/texture_factory.h"

namespace pbrt {

/// How lights are chosen for shadow rays: what can be varied over one built scene.
struct LightChoice {
    std::string lightSampler;  ///< name[:key=value,...]; empty: the scene's
    bool meshLights = false;
    std::optional<int> maxDepth;  ///< empty: the scene's
};

struct BuiltIntegrator {
    std::unique_ptr<Integrator> integrator;
    std::string name, lightSamplerName, shootingSamplerName;  ///< the last two empty if there is none
    int maxDepth = 5;
};

/// The integrator that the scene and the command line ask for, kept so that more integrators can be made.
struct IntegratorRequest {
    Entity entity, sampler;
    BuildOptions options;
    const PluginRegistry *registry = nullptr;
    bool needsFootprints = true;
};

/// Everything a render needs, made from one description. Members are destroyed in reverse order.
struct BuiltScene {
    std::unique_ptr<TextureLibrary> textures;
    std::unique_ptr<Filter> filter;
    std::unique_ptr<Film> film;
    std::unique_ptr<Camera> camera;
    std::unique_ptr<Sampler> sampler;  ///< of the first batch of samplesPerPixel samples
    std::unique_ptr<Scene> scene;
    LightNames lightNames;  ///< of the scene's lights, for people
    std::unique_ptr<Integrator> integrator;
    IntegratorRequest integratorRequest;
    MemoryEstimate memory;  ///< as it was before building
    int samplesPerPixel = 16;
    bool disablePixelJitter = false, disableWavelengthJitter = false;
    std::string mseReferenceImage, mseReferenceOut;
    int seed = 0;
    int maxDepth = 5;
    std::string integratorName;
    std::string lightSamplerName, shootingSamplerName;  ///< empty if there is none
    std::string filename;  ///< of the picture; gets a suffix if something was left out, unless a flag named it
    std::vector<std::string> leftOut;  ///< what --ignore-media or --ignore-unsupported left out, with places
    Transform cameraFromWorld;         ///< when the shutter opens; for image metadata

    /// The settings for the render, from the scene and the command line.
    RenderSettings Settings() const;
    /// Makes sampler and integrator again, as --spp does for this number of samples per pixel.
    void SetSamples(int samples);
    /// The context for Integrator::Prepare. The caller may change its seed and number of samples.
    PrepareContext Preparation(Progress &progress, Team &team = Team::Alone()) const;
    /// The context for RenderWaves with the scene's own integrator and film.
    RenderContext Rendering(Progress &progress, Team &team = Team::Alone()) const {
        return {*integrator, *camera, *filter, *film, *sampler, progress, team};
    }
    /// Prepares the scene's integrator: after this it can render.
    void Prepare(Progress &progress) {
        PrepareContext context = Preparation(progress);
        integrator->Prepare(context);
    }
};

/// One more integrator over the same scene and camera. The registry handed to BuildScene must still exist. Throws
/// UserError.
BuiltIntegrator MakeIntegrator(const BuiltScene &built, const LightChoice &choice);

/// The scene's integrator with light samplers that learn nothing and are prepared at once, without guide.
std::unique_ptr<Integrator> MakePlainIntegrator(const BuiltScene &built);

/// Turns a description into something that renders. Throws one UserError with everything that is wrong or not supported
/// yet; warnings stay in the sink. `description` may be dropped afterwards. `progress` shows the parts of the work as
/// phases; the caller begins and ends the phase of the whole.
BuiltScene BuildScene(SceneDescription &description, const BuildOptions &options, const PluginRegistry &registry,
                      DiagnosticSink &sink, Progress &progress);

/// Reports everything the description uses that the format has but this renderer does not support: as errors, or as
/// warnings where the options leave it out. What is left out is returned, one line each, and replaced in
/// `description` and `options` by what is built instead.
std::vector<std::string> CheckSupported(SceneDescription &description, BuildOptions &options, DiagnosticSink &sink);

}  // namespace pbrt
