#pragma once
#include "pbrt/math/vec.h"

namespace pbrt {

/// Orthonormal basis; local z is the normal.
struct Frame {
    Vector3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

    static Frame FromZ(const Vector3 &z) {
        Frame f;
        f.z = z;
        CoordinateSystem(z, &f.x, &f.y);
        return f;
    }
    /// Keeps the unit vector z exactly; x may have any length and is orthogonalised.
    static Frame FromXZ(const Vector3 &x, const Vector3 &z) {
        Vector3 xo = x - z * Dot(x, z);
        if (!(LengthSquared(xo) > 1e-20f * LengthSquared(x))) return FromZ(z);
        xo = Normalize(xo);
        return {xo, Cross(z, xo), z};
    }
    Vector3 ToLocal(const Vector3 &v) const { return {Dot(v, x), Dot(v, y), Dot(v, z)}; }
    Vector3 FromLocal(const Vector3 &v) const { return x * v.x + y * v.y + z * v.z; }
};

inline Float CosTheta(const Vector3 &w) { return w.z; }
inline Float AbsCosTheta(const Vector3 &w) { return std::abs(w.z); }
inline Float Sin2Theta(const Vector3 &w) { return std::max(Float(0), 1 - w.z * w.z); }
inline Float SinTheta(const Vector3 &w) { return std::sqrt(Sin2Theta(w)); }
inline bool SameHemisphere(const Vector3 &a, const Vector3 &b) { return a.z * b.z > 0; }

/// Rotates v by the smallest rotation from unit vector `from` to `to`, which must not be opposite.
inline Vector3 RotateFromTo(const Vector3 &from, const Vector3 &to, const Vector3 &v) {
    const Vector3 axis = Cross(from, to), turned = Cross(axis, v);
    return v + turned + Cross(axis, turned) / (1 + Dot(from, to));
}

}  // namespace pbrt
