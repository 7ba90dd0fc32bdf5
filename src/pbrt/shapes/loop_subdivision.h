#pragma once
#include <span>

#include "pbrt/shapes/triangle_mesh.h"

namespace pbrt {

/// Refines a triangle control mesh `levels` times by Loop subdivision, then projects vertices and normals to the limit
/// surface. The masks are stock pbrt-v4's (see the .cpp), so the surface is stock's; OpenSubdiv provides the topology.
/// The result is in the space of `points`. Like stock's, normals point to the side from which faces appear clockwise.
///
/// Throws UserError, without location, unless the faces are an oriented two-manifold, possibly with boundary. Unused
/// points are dropped. Indices must be in range.
MeshData LoopSubdivide(std::span<const uint32_t> indices, std::span<const Point3> points, int levels);

}  // namespace pbrt
