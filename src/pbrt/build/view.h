#pragma once
#include <memory>

#include "pbrt/build/build_options.h"
#include "pbrt/cameras/camera.h"
#include "pbrt/films/film.h"
#include "pbrt/films/filter.h"
#include "pbrt/samplers/sampler.h"
#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

/// Camera placement and the resulting rendering space.
struct Placement {
    bool isKnown = false;  ///< false: invalid placement; all transforms are identities
    Transform renderFromWorld;
    AnimatedTransform worldFromCamera, renderFromCamera;
};

/// Errors go to the sink.
Placement PlaceCamera(const SceneDescription &description, const BuildOptions &options, DiagnosticSink &sink);

/// Camera, film and sampling. Members with invalid parameters are null.
struct RenderView {
    std::unique_ptr<Filter> filter;
    std::unique_ptr<Film> film;
    std::unique_ptr<Camera> camera;
    std::unique_ptr<Sampler> sampler;
};

FilmOverrides FilmOverridesOf(const BuildOptions &options);

/// Cheap, so errors are reported before geometry is read. `seed`: used unless the scene's sampler has one.
RenderView MakeView(SceneDescription &description, const BuildOptions &options, const Placement &placement, int seed,
                    DiagnosticSink &sink);

}  // namespace pbrt
