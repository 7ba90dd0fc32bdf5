#pragma once
#include <string>

#include "pbrt/shapes/triangle_mesh.h"

namespace pbrt {

/// The faces of a PLY file, triangles and quads apart. Quads in patch order (corners 0, 1, 3, 2 of the face). Both
/// share the file's vertices; the data of a kind that does not occur has no indices and no vertices.
struct PlyMesh {
    MeshData triangles, quads;
    size_t ignoredFaces = 0;      ///< with another number of corners
    size_t brokenAttributes = 0;  ///< normals and uv that were infinite or not a number, and are 0 here
};

/// Reads the content of a PLY file (ascii, binary of both byte orders; already decompressed). Throws UserError, without
/// location but with `name` and the line or item, if it is malformed, has no vertices or no faces, or names a vertex
/// that does not exist, or if a position is not finite.
PlyMesh ParsePly(const std::string &content, const std::string &name);

}  // namespace pbrt
