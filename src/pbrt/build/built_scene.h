#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/cameras/camera.h"
#include "pbrt/films/filter.h"
#include "pbrt/films/render_file.h"
#include "pbrt/integrators/registry.h"
#include "pbrt/integrators/render_loop.h"
#include "pbrt/lights/light_names.h"
#include "pbrt/scene/scene.h"
#include "pbrt/scenefile/scene_description.h"
#include "pbrt/textures/texture_factory.h"

namespace pbrt {

/// A file of a flag or of the scene.
struct NamedFile {
    std::string owner;  ///< such as "--outfile", for messages
    std::string path;
    FileLoc loc{};
};

/// What the command line changes of a scene; the defaults change nothing. Invalid values are reported when building, by
/// the flag or directive that set them.
struct BuildOptions {
    FilmOverrides film;
    int samplesPerPixel = 0;  ///< --spp; 0: the scene's
    std::optional<int> seed;  ///< --seed
    bool quick = false;       ///< a quarter of the resolution; one sample unless samplesPerPixel is set
    bool ignoreMedia = false, ignoreUnsupported = false;  ///< replace unsupported features, with warnings
    bool checksOutput = false;                        ///< error before building if the film's file cannot be written
    std::string integrator;                           ///< --integrator name; empty: the scene's
    std::optional<int> maxDepth;                      ///< --maxdepth
    bool sampledLightOnly = false;                    ///< PathSettings::sampledLightOnly
    bool guide = false;                               ///< --guide
    bool adaptive = false;                            ///< --adaptive
    std::string lightSampler;                         ///< --lightsampler, see LightFlags; empty: the scene's
    bool meshLights = false;                          ///< --mesh-lights
    std::string shootingSampler;                      ///< --shooting-sampler name[:key=value,...]; empty: the scene's
    const char *lightSamplerFlag = "--lightsampler";  ///< flag that set lightSampler, for messages
    std::optional<Float> displacementEdgeScale;       ///< --displacement-edge-scale; empty: the scene's or 1
    std::string renderCoordSys;                       ///< camera, cameraworld, world; empty: the scene's or cameraworld
    bool disableTextureFiltering = false, forceDiffuse = false;
    int textureCacheMb = 0;  ///< --texture-cache-mb; 0: all images in memory
    bool disablePixelJitter = false, disableWavelengthJitter = false;
    std::string mseReferenceImage, mseReferenceOut;  ///< empty: the scene's Option, if any
    std::vector<NamedFile> inputs, outputs;          ///< further files that no output may replace, or that are written
};

/// Camera placement and the resulting rendering space; identities if the placement is invalid.
struct Placement {
    Transform renderFromWorld;
    AnimatedTransform worldFromCamera, renderFromCamera;
    Point3 eye{};  ///< of the camera at the middle of the transform times, in world space
};

/// Errors go to the sink.
Placement PlaceCamera(const SceneDescription &description, const BuildOptions &options, DiagnosticSink &sink);

/// Camera, film and sampling. Members with invalid parameters are null.
struct RenderView {
    std::unique_ptr<Filter> filter;
    std::unique_ptr<Film> film;
    std::unique_ptr<Camera> camera;
    std::unique_ptr<Sampler> sampler;
    std::unique_ptr<Film> half;  ///< RenderContext::half
};

inline FilmOverrides FilmOverridesOf(const BuildOptions &options) {
    FilmOverrides overrides = options.film;
    if (options.quick) overrides.resolutionDivisor = 4;
    return overrides;
}

/// Cheap, so errors are reported before geometry is read. `seed`: used unless the scene's sampler has one.
RenderView MakeView(SceneDescription &description, const BuildOptions &options, const Placement &placement, int seed,
                    DiagnosticSink &sink);

/// Light selection options that can vary over one built scene.
struct LightChoice {
    std::string lightSampler;  ///< name[:key=value,...]; empty: the scene's
    bool meshLights = false;
    std::optional<int> maxDepth;  ///< empty: the scene's
};

struct BuiltIntegrator {
    std::unique_ptr<Integrator> integrator;
    std::string integratorName;
    std::string lightSamplerName, shootingSamplerName;  ///< empty if there is none
    int maxDepth = 5;
};

/// The requested integrator, stored so that further integrators can be created.
struct IntegratorRequest {
    Entity entity, sampler;
    BuildOptions options;
    const PluginRegistry *registry = nullptr;
    bool needsFootprints = true;
};

/// Lower bound of a scene's memory before building: film sums; meshes, by parameters or file headers, with their
/// acceleration structure; images, by PNG headers and other files' sizes. Excludes curves, quadrics, displaced meshes,
/// volumes, lights and learned structures.
struct MemoryEstimate {
    double film = 0, meshes = 0, images = 0;  ///< bytes
    double triangles = 0;
    int imageCount = 0;
    FileLoc largestAt{};  ///< directive of the largest mesh or image
    double largest = 0;   ///< its bytes

    double Total() const { return film + meshes + images; }
    void Include(double bytes, const FileLoc &at) {
        if (!(bytes > largest)) return;
        largest = bytes;
        largestAt = at;
    }
    /// "2.1 GB: meshes 1.9 GB (20 million triangles), 3 images 180 MB, film 59 MB".
    std::string Text() const {
        std::string text = fmt::format("{}: ", BytesText(Total()));
        if (meshes > 0)
            text += fmt::format("meshes {} ({:.{}f} million triangles), ", BytesText(meshes), triangles / 1e6,
                                triangles < 1e7 ? 1 : 0);
        if (images > 0)
            text += fmt::format("{} image{} {}, ", imageCount, imageCount == 1 ? "" : "s", BytesText(images));
        return text + fmt::format("film {}", BytesText(film));
    }
};

/// `imagesInMemory` false: images are in the tile cache and excluded.
MemoryEstimate EstimateMemory(const SceneDescription &description, double filmBytes, bool imagesInMemory);

/// Throws UserError, at the largest directive, if the estimate exceeds this process's memory.
inline void RequireMemory(const MemoryEstimate &estimate) {
    const double usable = UsableMemory();
    if (estimate.Total() > usable)
        throw UserError(estimate.largestAt, "the scene needs at least {}; this process can use {} of memory.",
                        estimate.Text(), BytesText(usable));
}

/// Everything a render needs, from one description. The sampler is for the first batch of samplesPerPixel samples.
/// Members are destroyed in reverse order.
struct BuiltScene : RenderView, BuiltIntegrator {
    std::unique_ptr<TextureLibrary> textures;
    std::unique_ptr<Scene> scene;
    LightNames lightNames;  ///< for messages
    IntegratorRequest integratorRequest;
    MemoryEstimate memory;  ///< before building
    int samplesPerPixel = 16;
    bool disablePixelJitter = false, disableWavelengthJitter = false;
    std::string mseReferenceImage, mseReferenceOut;
    int seed = 0;
    std::string filename;              ///< of the image; suffixed if features were left out, unless set by a flag
    std::vector<std::string> leftOut;  ///< features left out by --ignore-media or --ignore-unsupported, with locations
    Transform cameraFromWorld;         ///< at shutter open; for image metadata

    RenderSettings Settings() const {
        RenderSettings settings;
        settings.samplesPerPixel = samplesPerPixel;
        settings.disablePixelJitter = disablePixelJitter;
        settings.disableWavelengthJitter = disableWavelengthJitter;
        settings.mseReferenceImage = mseReferenceImage;
        settings.mseReferenceOut = mseReferenceOut;
        return settings;
    }
    /// Recreates sampler and integrator for this number of samples per pixel, as --spp.
    void SetSamples(int samples);
    /// Context for Integrator::Prepare. The caller may change seed and samples.
    PrepareContext Preparation(Progress &progress, Team &team = Team::Alone()) const {
        return {.scene = *scene,
                .camera = *camera,
                .filter = *filter,
                .sampler = *sampler,
                .pixelBounds = film->PixelBounds(),
                .seed = seed,
                .samplesPerPixel = samplesPerPixel,
                .maxDepth = maxDepth,
                .progress = progress,
                .team = team};
    }
    RenderContext Rendering(Progress &progress, Team &team = Team::Alone()) const {
        return {*integrator, *camera, *filter, *film, *sampler, progress, team, half.get()};
    }
    void Prepare(Progress &progress) {
        PrepareContext context = Preparation(progress);
        integrator->Prepare(context);
    }
};

/// Creates a further integrator for the same scene and camera. The registry passed to BuildScene must still exist.
/// Throws UserError.
BuiltIntegrator MakeIntegrator(const BuiltScene &built, const LightChoice &choice);

/// Creates the scene's integrator with light samplers that do not learn, prepared at once, without guiding.
std::unique_ptr<Integrator> MakePlainIntegrator(const BuiltScene &built);

/// Builds a renderable scene. Throws one UserError with all errors and unsupported features; warnings stay in the sink.
/// `description` may be discarded afterwards. `progress` shows the steps as phases within the caller's phase.
BuiltScene BuildScene(SceneDescription &description, const BuildOptions &options, const PluginRegistry &registry,
                      DiagnosticSink &sink, Progress &progress);

/// Reports all unsupported features of the format: as errors, or as warnings if the options leave them out. Returns
/// those left out, one line each, and replaces them in `description` and `options`.
std::vector<std::string> CheckSupported(SceneDescription &description, BuildOptions &options, DiagnosticSink &sink);

/// Everything that a render's samples depend on, except their number: program, scene files, and flags. Throws UserError
/// for standard input, which cannot be read twice.
RenderIdentity IdentityOf(const BuildOptions &options, const std::vector<std::string> &sceneFiles,
                          const SceneDescription &description);

/// Requirements for two renders to share learned light selection: program, light sampler, scene bounds and lights by
/// name. Cameras, films and materials may differ.
RenderIdentity LightIdentity(const Scene &scene, const std::string &lightSampler, const std::string &parameters);

/// Reports unknown names in the directives that nothing is built from, SceneDescription::unbuilt.
void CheckUnbuilt(const SceneDescription &description, const PluginRegistry &registry, DiagnosticSink &sink);

/// Text of `pbrt --list WHAT`: a family; "all": docs/reference/parameters.md; "table": the table of
/// docs/reference/compatibility.md; "lightsamplertables": docs/reference/lightsamplers.md. Throws UserError with the
/// choices for anything else.
std::string ListWhat(const std::string &what, const PluginRegistry &registry);

}  // namespace pbrt
