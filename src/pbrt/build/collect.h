#pragma once
#include "pbrt/core/error.h"
#include "pbrt/math/animated_transform.h"
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

}  // namespace pbrt
