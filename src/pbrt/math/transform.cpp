#include "pbrt/math/transform.h"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

namespace pbrt {

glm::mat4 Transform::InverseOf(const glm::mat4 &m) {
    glm::mat4 inverse(glm::inverse(glm::dmat4(m)));
    if (m[0][3] == 0 && m[1][3] == 0 && m[2][3] == 0 && m[3][3] == 1) {
        for (int c = 0; c < 3; ++c) inverse[c][3] = 0;
        inverse[3][3] = 1;
    }
    return inverse;
}

bool Transform::IsFinite() const {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(m_[c][r])) return false;
    return true;
}

std::optional<double> Transform::UniformScale(double tolerance) const {
    const glm::dmat3 m(m_), gram = glm::transpose(m) * m;
    double s2 = (gram[0][0] + gram[1][1] + gram[2][2]) / 3, deviation = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) deviation = std::max(deviation, std::abs(gram[i][j] - (i == j ? s2 : 0)));
    if (!(deviation <= tolerance * s2)) return {};
    return std::sqrt(s2);
}

Transform Transform::FromFile(const std::array<Float, 16> &v) { return Transform(glm::make_mat4(v.data())); }

Transform Transform::Translate(const Vector3 &t) {
    return {glm::translate(glm::mat4(1), t), glm::translate(glm::mat4(1), -t)};
}

Transform Transform::Scale(const Vector3 &s) {
    return {glm::scale(glm::mat4(1), s), glm::scale(glm::mat4(1), Vector3(1) / s)};
}

Transform Transform::Rotate(Float degrees, const Vector3 &axis) {
    glm::mat4 m = glm::rotate(glm::mat4(1), Radians(degrees), Normalize(axis));
    return {m, glm::transpose(m)};
}

std::optional<Transform> Transform::LookAt(const Point3 &eye, const Point3 &look, const Vector3 &up) {
    if (eye == look || !(LengthSquared(up) > 0)) return {};
    Vector3 forward = Normalize(look - eye);
    Vector3 side = Cross(Normalize(up), forward);
    if (!(Length(side) > 0)) return {};
    Vector3 right = Normalize(side);
    Vector3 top = Cross(forward, right);
    glm::mat4 cameraToWorld(glm::vec4(right, 0), glm::vec4(top, 0), glm::vec4(forward, 0), glm::vec4(eye, 1));
    return Transform(cameraToWorld).Inverse();
}

Transform Transform::Perspective(Float fovDegrees, Float near, Float far) {
    Float depth = far / (far - near);
    glm::mat4 projection(glm::vec4(1, 0, 0, 0), glm::vec4(0, 1, 0, 0), glm::vec4(0, 0, depth, 1),
                         glm::vec4(0, 0, -near * depth, 0));
    Float scale = 1 / std::tan(Radians(fovDegrees) / 2);
    return Scale({scale, scale, 1}) * Transform(projection);
}

Transform Transform::Orthographic(Float near, Float far) {
    return Scale({1, 1, 1 / (far - near)}) * Translate({0, 0, -near});
}

Vector3 Transform::PointError(const Point3 &p, const Vector3 &pError) const {
    glm::mat3 a;
    for (int c = 0; c < 3; ++c) a[c] = glm::abs(Vector3(m_[c]));
    Vector3 magnitude = a * glm::abs(p) + glm::abs(Vector3(m_[3]));
    return (1 + Gamma(3)) * (a * pError) + Gamma(3) * magnitude;
}

}  // namespace pbrt
