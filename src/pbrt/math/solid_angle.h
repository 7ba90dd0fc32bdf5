#pragma once
#include "pbrt/math/transform.h"

namespace pbrt {

// How an affine map M changes measures. A unit vector d is taken to M d / |M d|; a small solid angle around d is
// multiplied by |det M| / |M d|^3, and a small area across d by |det M| / |M d|.

inline Float VolumeScale(const Transform &m) { return std::abs(glm::determinant(glm::mat3(m.Matrix()))); }

/// The density by solid angle, in the space that m maps to, of the direction w (unit, there) whose original has the
/// density `pdf`.
inline Float MappedDirectionPdf(const Transform &m, const Vector3 &w, Float pdf) {
    // M^-1 w = d / |M d|.
    const Float inverse = 1 / Length(m.InverseVector(w));
    return pdf * inverse * inverse * inverse / VolumeScale(m);
}

}  // namespace pbrt
