#pragma once
#include <span>
#include <string>

#include "pbrt/shapes/triangle_mesh.h"

namespace pbrt {

/// Triangles and quads of a PLY file. Quads are in patch order (corners 0, 1, 3, 2 of the face). Both share the file's
/// vertices; absent kinds have no indices and no vertices.
struct PlyMesh {
    MeshData triangles, quads;
    size_t ignoredFaces = 0;      ///< with another number of corners
    size_t brokenAttributes = 0;  ///< non-finite normals and uv, replaced by 0
};

/// Parses a PLY file (ascii, or binary of either byte order; already decompressed). Throws UserError, without location
/// but with `name` and the line or item, for malformed files, missing vertices or faces, indices out of range, and
/// non-finite positions.
PlyMesh ParsePly(const std::string &content, const std::string &name);

/// Refines a triangle control mesh `levels` times by Loop subdivision, then projects vertices and normals to the limit
/// surface. The masks are stock pbrt-v4's (see the .cpp), so the surface is stock's; OpenSubdiv provides the topology.
/// The result is in the space of `points`. Like stock's, normals point to the side from which faces appear clockwise.
///
/// Throws UserError, without location, unless the faces are an oriented two-manifold, possibly with boundary. Unused
/// points are dropped. Indices must be in range.
MeshData LoopSubdivide(std::span<const uint32_t> indices, std::span<const Point3> points, int levels);

}  // namespace pbrt
