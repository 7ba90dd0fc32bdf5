#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/core/ids.h"
#include "pbrt/media/medium.h"
#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

struct BuiltMedia {
    std::vector<std::unique_ptr<Medium>> media;  ///< by MediumId
    std::map<std::string, MediumId> ids;

    /// No medium for "" (vacuum) and for media that failed to build.
    MediumId Find(const std::string &name) const {
        auto it = ids.find(name);
        return it == ids.end() ? MediumId() : it->second;
    }
};

/// Builds all media of the scene, including unused ones, so that all errors are reported to the sink. Frees value lists
/// of the description.
BuiltMedia MakeMedia(SceneDescription &description, const Transform &renderFromWorld, DiagnosticSink &sink);

}  // namespace pbrt
