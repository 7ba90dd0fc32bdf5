#pragma once
#include <string>
#include <vector>

#include "pbrt/build/built_scene.h"
#include "pbrt/films/render_file.h"
#include "pbrt/scene/scene.h"
#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

/// Everything that a render's samples depend on, except their number: program, scene files, and flags. Throws UserError
/// for standard input, which cannot be read twice.
RenderIdentity IdentityOf(const BuildOptions &options, const std::vector<std::string> &sceneFiles,
                          const SceneDescription &description);

/// Requirements for two renders to share learned light selection: program, light sampler, scene bounds and lights by
/// name. Cameras, films and materials may differ.
RenderIdentity LightIdentity(const Scene &scene, const std::string &lightSampler, const std::string &parameters);

}  // namespace pbrt
