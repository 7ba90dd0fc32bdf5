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

/// The ids of media by their names.
class MediumIds {
  public:
    void Add(const std::string &name, MediumId id) { ids_.emplace(name, id); }
    /// No medium for "", which is vacuum, and for a medium that could not be made.
    MediumId Find(const std::string &name) const {
        auto it = ids_.find(name);
        return it == ids_.end() ? MediumId() : it->second;
    }

  private:
    std::map<std::string, MediumId> ids_;
};

struct BuiltMedia {
    std::vector<std::unique_ptr<Medium>> media;  ///< by MediumId
    MediumIds ids;
};

/// Makes all media of the scene, also those that nothing is in, so that their mistakes are found; these go to the sink.
/// Lists of values are dropped from the description.
BuiltMedia MakeMedia(SceneDescription &description, const Transform &renderFromWorld, DiagnosticSink &sink);

}  // namespace pbrt
