#pragma once
#include <memory>

#include "pbrt/build/build_options.h"
#include "pbrt/cameras/camera.h"
#include "pbrt/films/film.h"
#include "pbrt/films/filter.h"
#include "pbrt/samplers/sampler.h"
#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

/// Where the camera stands, and where that puts rendering space.
struct Placement {
    bool isKnown = false;  ///< false: the scene's is an error, and all transforms are identities
    Transform renderFromWorld;
    AnimatedTransform worldFromCamera, renderFromCamera;
};

/// Mistakes go to the sink, as with all stages.
Placement PlaceCamera(const SceneDescription &description, const BuildOptions &options, DiagnosticSink &sink);

/// What looks at the scene. Null: its parameters were an error.
struct View {
    std::unique_ptr<Filter> filter;
    std::unique_ptr<Film> film;
    std::unique_ptr<Camera> camera;
    std::unique_ptr<Sampler> sampler;
};

/// All of this is cheap, so its mistakes are found before any geometry is read. `seed`: unless the scene's sampler has
/// one of its own.
View MakeView(SceneDescription &description, const BuildOptions &options, const Placement &placement, int seed,
              DiagnosticSink &sink);

}  // namespace pbrt
