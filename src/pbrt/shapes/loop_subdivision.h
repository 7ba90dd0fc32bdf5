#pragma once
#include <span>

#include "pbrt/shapes/triangle_mesh.h"

namespace pbrt {

/// Refines a triangle control mesh `levels` times by Loop subdivision, then moves its vertices to the limit surface and
/// gives them the limit's normals. The masks are those stock pbrt-v4 uses (see the .cpp), so the surface is stock's;
/// OpenSubdiv provides the topology. The result lies in the space of `points`. Like stock's, normals point to the side
/// from which the faces are seen clockwise.
///
/// Throws UserError, without location, if the faces are no oriented two-manifold (with or without boundary). Points
/// that no face uses are dropped. Indices must be in range.
MeshData LoopSubdivide(std::span<const uint32_t> indices, std::span<const Point3> points, int levels);

}  // namespace pbrt
