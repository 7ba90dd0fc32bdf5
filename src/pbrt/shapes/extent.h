#pragma once
#include <string>

#include "pbrt/core/params.h"
#include "pbrt/math/animated_transform.h"
#include "pbrt/shapes/shape.h"

namespace pbrt {

/// True if all coordinates lie in kCoordinateRange.
inline bool IsWithinReach(const Point3 &p) {
    return kCoordinateRange.Contains(p.x) && kCoordinateRange.Contains(p.y) && kCoordinateRange.Contains(p.z);
}
inline bool IsWithinReach(const Bounds3 &b) { return b.IsEmpty() || (IsWithinReach(b.low) && IsWithinReach(b.high)); }

Bounds3 TransformBounds(const Transform &t, const Bounds3 &b);  ///< of the transformed box
Bounds3 BoundsOf(const Shape &shape);                           ///< of all vertices or primitives

/// Throws UserError "`what` reaches to ...; coordinates must be ..." unless the box, placed at the start and end of its
/// motion, lies within kMaxCoordinate.
void RequireReach(const std::string &what, const AnimatedTransform &place, const Bounds3 &b, const FileLoc &loc);

/// The same for a shape in its own space. For meshes the error names the first offending vertex.
void RequireReach(const std::string &what, const Shape &shape, const FileLoc &loc);

}  // namespace pbrt
