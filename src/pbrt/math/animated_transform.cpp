#include "pbrt/math/animated_transform.h"

#include "pbrt/core/error.h"

namespace pbrt {
namespace {

double LargestElement(const glm::dmat3 &m) {
    double largest = 0;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) largest = std::max(largest, std::abs(m[c][r]));
    return largest;
}

/// Orthogonal factor of the polar decomposition of a non-singular matrix, by Newton's iteration (Higham 1986).
glm::dmat3 OrthogonalFactor(glm::dmat3 m) {
    constexpr int kMaxSteps = 100;
    for (int i = 0; i < kMaxSteps; ++i) {
        const glm::dmat3 next = (m + glm::transpose(glm::inverse(m))) * 0.5;
        const double change = LargestElement(next - m);
        m = next;
        if (change < 1e-14) break;
    }
    return m;
}

}  // namespace

Transform Product(std::initializer_list<Transform> factors) {
    glm::dmat4 product(1);
    for (const Transform &t : factors) product *= glm::dmat4(t.Matrix());
    return Transform(glm::mat4(product));
}

AnimatedTransform::AnimatedTransform(const Transform &start, Float startTime, const Transform &end, Float endTime)
    : start_(start), end_(end), startTime_(startTime), endTime_(endTime), isAnimated_(!(start == end)) {
    if (!isAnimated_) return;
    PBRT_CHECK(CanInterpolate(start, end));
    first_ = Decompose(glm::dmat4(start.Matrix()));
    last_ = Decompose(glm::dmat4(end.Matrix()));
    if (glm::dot(first_.rotation, last_.rotation) < 0) last_.rotation = -last_.rotation;
}

bool AnimatedTransform::CanInterpolate(const Transform &start, const Transform &end) {
    return !start.IsSingular() && !end.IsSingular() && start.SwapsHandedness() == end.SwapsHandedness();
}

AnimatedTransform::Decomposition AnimatedTransform::Decompose(const glm::dmat4 &m) {
    const glm::dmat3 linear(m);
    glm::dmat3 rotation = OrthogonalFactor(linear);
    if (glm::determinant(rotation) < 0) rotation = -rotation;  // mirroring belongs to the scale
    return {glm::dvec3(m[3]), glm::normalize(glm::quat_cast(rotation)), glm::transpose(rotation) * linear};
}

Transform AnimatedTransform::At(Float time) const {
    if (!isAnimated_ || time <= startTime_) return start_;
    if (time >= endTime_) return end_;
    const double t = (double(time) - double(startTime_)) / (double(endTime_) - double(startTime_));
    const glm::dmat3 linear =
        glm::mat3_cast(glm::slerp(first_.rotation, last_.rotation, t)) * (first_.scale * (1 - t) + last_.scale * t);
    glm::dmat4 m(linear);
    m[3] = glm::dvec4(glm::mix(first_.translation, last_.translation, t), 1);
    return Transform(glm::mat4(m));
}

bool AnimatedTransform::KeepsAxes() const {
    constexpr double kAngle = 1e-7;
    auto isDiagonal = [](const glm::dmat3 &m) {
        const double size = LargestElement(m);
        for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r)
                if (r != c && std::abs(m[c][r]) > 1e-6 * size) return false;
        return true;
    };
    return !isAnimated_ || (1 - glm::dot(first_.rotation, last_.rotation) < kAngle * kAngle &&
                            isDiagonal(first_.scale) && isDiagonal(last_.scale));
}

}  // namespace pbrt
