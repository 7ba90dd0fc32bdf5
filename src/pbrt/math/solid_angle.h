#pragma once
#include "pbrt/math/transform.h"

namespace pbrt {

// Change of measure under an affine map M. A unit vector d maps to M d / |M d|; solid angle around d scales by |det M|
// / |M d|^3, area across d by |det M| / |M d|.

inline Float VolumeScale(const Transform &m) { return std::abs(glm::determinant(glm::mat3(m.Matrix()))); }

/// Solid-angle density, in the target space of m, of unit direction w whose preimage has density `pdf`.
inline Float MappedDirectionPdf(const Transform &m, const Vector3 &w, Float pdf) {
    const Float inverse = 1 / Length(m.InverseVector(w));
    return pdf * inverse * inverse * inverse / VolumeScale(m);
}

}  // namespace pbrt
