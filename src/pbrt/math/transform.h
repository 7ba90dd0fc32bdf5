#pragma once
#include <array>
#include <optional>

#include "pbrt/math/ray.h"

namespace pbrt {

/// 4x4 matrix and its inverse. Matrices are GLM's: column-major with column vectors, the order of scene files (elements
/// 12-14 are the translation).
class Transform {
  public:
    Transform() = default;
    explicit Transform(const glm::mat4 &m) : m_(m), inverse_(InverseOf(m)) {}
    Transform(const glm::mat4 &m, const glm::mat4 &inverse) : m_(m), inverse_(inverse) {}

    static Transform FromFile(const std::array<Float, 16> &v);
    static Transform Translate(const Vector3 &t);
    static Transform Scale(const Vector3 &s);
    /// Degrees, right-handed about `axis` (any length).
    static Transform Rotate(Float degrees, const Vector3 &axis);
    /// World-to-camera of pbrt's left-handed LookAt; nullopt if up is parallel to the view direction or eye = look.
    static std::optional<Transform> LookAt(const Point3 &eye, const Point3 &look, const Vector3 &up);
    /// pbrt's perspective projection: x, y divided by z and tan(fov/2); z from [near, far] to [0, 1].
    static Transform Perspective(Float fovDegrees, Float near, Float far);
    static Transform Orthographic(Float near, Float far);

    const glm::mat4 &Matrix() const { return m_; }
    const glm::mat4 &InverseMatrix() const { return inverse_; }
    Transform Inverse() const { return {inverse_, m_}; }
    Transform operator*(const Transform &o) const { return {m_ * o.m_, o.inverse_ * inverse_}; }
    bool operator==(const Transform &o) const { return m_ == o.m_; }
    bool IsIdentity() const { return m_ == glm::mat4(1); }
    bool SwapsHandedness() const { return Determinant3() < 0; }
    /// True if the transform is singular, or nearly so: the inverse has non-finite elements.
    bool IsSingular() const { return !(std::abs(Determinant3()) > 0) || !Transform(inverse_, m_).IsFinite(); }
    /// Factor of lengths; empty if those of vectors differ. `tolerance`: relative, of squared lengths.
    std::optional<double> UniformScale(double tolerance) const;
    /// False if an element of the matrix (not of the inverse) is not finite.
    bool IsFinite() const;

    /// Divides by w only for projective matrices.
    Point3 Point(const Point3 &p) const { return Apply(m_, p); }
    Vector3 Vector(const Vector3 &v) const { return glm::mat3(m_) * v; }
    /// Multiplies by the inverse transpose; not normalised.
    Normal3 Normal(const Normal3 &n) const { return n * glm::mat3(inverse_); }
    Point3 InversePoint(const Point3 &p) const { return Apply(inverse_, p); }
    Vector3 InverseVector(const Vector3 &v) const { return glm::mat3(inverse_) * v; }
    Normal3 InverseNormal(const Normal3 &n) const { return n * glm::mat3(m_); }
    /// Rounding error bound of Point(p) for p with error bounds `pError`.
    Vector3 PointError(const Point3 &p, const Vector3 &pError = Vector3(0)) const;

  private:
    /// Inverts in double precision; exactly affine if m is.
    static glm::mat4 InverseOf(const glm::mat4 &m);
    double Determinant3() const { return glm::determinant(glm::dmat3(glm::mat3(m_))); }
    static Point3 Apply(const glm::mat4 &m, const Point3 &p) {
        glm::vec4 q = m * glm::vec4(p, 1);
        if (q.w == 1) return Point3(q);
        return Point3(q) / q.w;
    }
    glm::mat4 m_{1};
    glm::mat4 inverse_{1};
};

// Change of measure under an affine map M. A unit vector d maps to M d / |M d|; solid angle around d scales by |det M|
// / |M d|^3, area across d by |det M| / |M d|.

/// |det M|: volume after the map over volume before.
inline Float VolumeScale(const Transform &m) { return std::abs(glm::determinant(glm::mat3(m.Matrix()))); }

/// Solid-angle density, in the target space of m, of unit direction w whose preimage has density `pdf`.
inline Float MappedDirectionPdf(const Transform &m, const Vector3 &w, Float pdf) {
    const Float inverse = 1 / Length(m.InverseVector(w));
    return pdf * inverse * inverse * inverse / VolumeScale(m);
}

}  // namespace pbrt
