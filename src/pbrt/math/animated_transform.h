#pragma once
#include <glm/gtc/quaternion.hpp>

#include "pbrt/math/transform.h"

namespace pbrt {

/// A transform that moves from one matrix to another. In between, both are taken apart into translation, rotation and
/// scale (a symmetric matrix), which are interpolated linearly, along the shortest great arc, and linearly. Before
/// `startTime` and after `endTime` it stands still.
class AnimatedTransform {
  public:
    AnimatedTransform() = default;
    /// One that does not move.
    AnimatedTransform(const Transform &still) : start_(still), end_(still) {}
    /// Both affine; if they differ, CanInterpolate(start, end).
    AnimatedTransform(const Transform &start, Float startTime, const Transform &end, Float endTime);

    /// False if one of them flattens or only one of them mirrors.
    static bool CanInterpolate(const Transform &start, const Transform &end);

    bool IsAnimated() const { return isAnimated_; }
    const Transform &Start() const { return start_; }
    Float StartTime() const { return startTime_; }
    Float EndTime() const { return endTime_; }
    Transform At(Float time) const;
    /// True if the motion is a straight one without turning or shearing.
    bool KeepsAxes() const;

  private:
    struct Parts {
        glm::dvec3 translation{0};
        glm::dquat rotation{1, 0, 0, 0};
        glm::dmat3 scale{1};
    };
    static Parts TakeApart(const glm::dmat4 &m);

    Transform start_, end_;
    Float startTime_ = 0, endTime_ = 1;
    bool isAnimated_ = false;
    Parts first_, last_;
};

}  // namespace pbrt
