#pragma once
#include "pbrt/core/error.h"
#include "pbrt/math/animated_transform.h"
#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

/// The motion of an entity whose CTMs at the two times were turned into `start` and `end`. Throws UserError if they
/// cannot be interpolated.
template <class Entity>
AnimatedTransform MotionOf(const char *what, const Entity &entity, const Transform &start, const Transform &end) {
    if (start == end) return start;
    if (!AnimatedTransform::CanInterpolate(start, end))
        throw UserError(fmt::format("{} cannot move from its start to its end transformation: one of them flattens it, "
                                    "or only one of them mirrors it.",
                                    what),
                        entity.loc);
    return {start, entity.startTime, end, entity.endTime};
}

}  // namespace pbrt
