#pragma once
#include "pbrt/math/vec.h"

namespace pbrt {

/// Derivatives of the unit normal n from first and second derivatives of the position (Weingarten equations).
inline void NormalDerivatives(const Vector3 &dpdu, const Vector3 &dpdv, const Vector3 &d2pduu, const Vector3 &d2pduv,
                              const Vector3 &d2pdvv, const Normal3 &n, Normal3 *dndu, Normal3 *dndv) {
    Float uu = Dot(dpdu, dpdu), uv = Dot(dpdu, dpdv), vv = Dot(dpdv, dpdv);
    Float e = Dot(n, d2pduu), f = Dot(n, d2pduv), g = Dot(n, d2pdvv);
    Float determinant = DifferenceOfProducts(uu, vv, uv, uv);
    Float inverse = determinant == 0 ? 0 : 1 / determinant;
    *dndu = ((f * uv - e * vv) * dpdu + (e * uv - f * uu) * dpdv) * inverse;
    *dndv = ((g * uv - f * vv) * dpdu + (f * uv - g * uu) * dpdv) * inverse;
}

}  // namespace pbrt
