#pragma once
#include <map>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/math/animated_transform.h"
#include "pbrt/media/medium_factory.h"
#include "pbrt/scenefile/scene_description.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

inline const ColorSpace &SpaceOf(const Entity &e) {
    const ColorSpace *space = ColorSpace::Find(e.colorSpace);
    PBRT_CHECK_MSG(space != nullptr, "colour space {}", e.colorSpace);
    return *space;
}

/// Motion of an entity with CTMs transformed to `start` and `end`. Throws UserError if they cannot be interpolated.
AnimatedTransform MotionOf(const char *what, const auto &entity, const Transform &start, const Transform &end) {
    if (start == end) return start;
    if (!AnimatedTransform::CanInterpolate(start, end))
        throw UserError(entity.loc,
                        "{} cannot move from its start to its end transformation: one of them flattens it, "
                        "or only one of them mirrors it.",
                        what);
    return {start, entity.startTime, end, entity.endTime};
}

struct BuiltMedia {
    std::vector<std::unique_ptr<Medium>> media;  ///< by MediumId
    std::map<std::string, MediumId> ids;

    /// No medium for "" (vacuum) and for media that failed to build.
    MediumId Find(const std::string &name) const {
        auto it = ids.find(name);
        return it == ids.end() ? MediumId() : it->second;
    }
};

/// Builds all media of the scene, also unused ones; errors go to the sink. Frees value lists of the description.
inline BuiltMedia MakeMedia(SceneDescription &description, const Transform &renderFromWorld, DiagnosticSink &sink) {
    BuiltMedia built;
    for (MediumEntity &m : description.media)
        Collect(sink, [&] {
            // In any file order; stock pbrt-v4 misplaces grids defined before Camera.
            const Transform renderFromMedium = renderFromWorld * m.ctm.start;
            auto medium =
                Media().Make(m.type, m.params, MediumContext{renderFromMedium, SpaceOf(m), description.files, sink});
            built.ids.emplace(m.name, MediumId(built.media.size()));
            built.media.push_back(std::move(medium));
            m.params = {};
        });
    return built;
}

}  // namespace pbrt
