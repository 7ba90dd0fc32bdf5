#pragma once
#include <string>
#include <vector>

#include "pbrt/build/build_options.h"
#include "pbrt/films/render_file.h"
#include "pbrt/scene/scene.h"
#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

/// Everything that the samples of a render depend on, but for the number of samples: the program, every file that the
/// scene names, and the flags. Throws UserError if the scene comes from standard input, which cannot be read twice.
RenderIdentity IdentityOf(const BuildOptions &options, const std::vector<std::string> &sceneFiles,
                          const SceneDescription &description);

/// What two renders must have in common to choose their lights by what one of them learned: the program, the light
/// sampler, the scene's bounds and its lights, by name. Cameras, films and materials may differ.
RenderIdentity LightIdentity(const Scene &scene, const std::string &lightSampler, const std::string &parameters);

}  // namespace pbrt
