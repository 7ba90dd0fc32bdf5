#pragma once
#include <glm/gtc/quaternion.hpp>
#include <initializer_list>

#include "pbrt/math/transform.h"

namespace pbrt {

/// Matrix product in double precision, rounded once.
Transform Product(std::initializer_list<Transform> factors);

/// Transform interpolated between two matrices, constant outside [startTime, endTime]. Decomposes into translation,
/// rotation and scale (a symmetric matrix); translation and scale are linear, the rotation follows the shortest great
/// arc.
class AnimatedTransform {
  public:
    AnimatedTransform() = default;
    AnimatedTransform(const Transform &still) : start_(still), end_(still) {}
    /// Both affine; if they differ, CanInterpolate(start, end) must hold.
    AnimatedTransform(const Transform &start, Float startTime, const Transform &end, Float endTime);

    /// False if a transform is singular or only one of them mirrors.
    static bool CanInterpolate(const Transform &start, const Transform &end);

    bool IsAnimated() const { return isAnimated_; }
    const Transform &Start() const { return start_; }
    Float StartTime() const { return startTime_; }
    Float EndTime() const { return endTime_; }
    Transform At(Float time) const;
    /// True if the transform is constant, or if the rotation is constant and the scales are along the coordinate axes.
    bool KeepsAxes() const;

  private:
    struct Decomposition {
        glm::dvec3 translation{0};
        glm::dquat rotation{1, 0, 0, 0};
        glm::dmat3 scale{1};
    };
    static Decomposition Decompose(const glm::dmat4 &m);

    Transform start_, end_;
    Float startTime_ = 0, endTime_ = 1;
    bool isAnimated_ = false;
    Decomposition first_, last_;
};

}  // namespace pbrt
