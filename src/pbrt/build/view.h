#pragma once
#include <memory>

#include "pbrt/build/build_options.h"
#include "pbrt/cameras/camera.h"
#include "pbrt/films/film.h"
#include "pbrt/films/filter.h"
#include "pbrt/samplers/sampler.h"
#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

/// Where the camera stands, and the rendering space that follows from it.
struct Placement {
    bool isKnown = false;  ///< false: the scene's placement is an error, and all transforms here are identities
    Transform renderFromWorld;
    AnimatedTransform worldFromCamera, renderFromCamera;
};

/// Mistakes go to the sink, as with all stages.
Placement PlaceCamera(const SceneDescription &description, const BuildOptions &options, DiagnosticSink &sink);

/// What turns the scene into a picture. A member is null if its parameters were an error.
struct View {
    std::unique_ptr<Filter> filter;
    std::unique_ptr<Film> film;
    std::unique_ptr<Camera> camera;
    std::unique_ptr<Sampler> sampler;
};

/// The overrides of the film that the flags ask for.
FilmOverrides FilmOverridesOf(const BuildOptions &options);

/// All of this is cheap, so its mistakes are found before any geometry is read. `seed`: used unless the scene's sampler
/// has a seed.
View MakeView(SceneDescription &description, const BuildOptions &options, const Placement &placement, int seed,
              DiagnosticSink &sink);

}  // namespace pbrt
