#pragma once
#include <functional>
#include <span>
#include <string>

#include "pbrt/core/error.h"
#include "pbrt/shapes/triangle_mesh.h"

namespace pbrt {

/// Triangles and quads of a PLY file. Quads are in patch order (corners 0, 1, 3, 2 of the face). Both share the file's
/// vertices; absent kinds have no indices and no vertices.
struct PlyMesh {
    MeshData triangles, quads;
    size_t ignoredFaces = 0;      ///< with another number of corners
    size_t brokenAttributes = 0;  ///< non-finite normals and uv, replaced by 0
    size_t surplusBytes = 0;      ///< after the last element, without white space before them
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

struct Displacement {
    /// Displacement along the normal in object units; position and (unit) normal are in rendering space.
    std::function<Float(const Point3 &p, const Normal3 &n, const Point2 &uv)> height;
    Float edgeScale = 1;  ///< multiplies "edgelength"
};

/// Displacement failure (no location) with the responsible parameter of the shape.
struct DisplacementError : UserError {
    DisplacementError(const char *name, std::string message) : UserError(std::move(message)), parameter(name) {}
    const char *parameter;  ///< "displacement" or "edgelength"
};

/// Bisects the longest edges of triangles and quads until all are shorter than `maxEdge` in rendering space. Then
/// displaces vertices along their normals and recomputes normals, on the side of the old ones. Shared vertices stay
/// shared: no cracks. The result is in object space. Throws DisplacementError if texture coordinates or normals are
/// missing or kMaxDisplacedTriangles is exceeded; nearly always before the work is done.
MeshData DisplaceMesh(const PlyMesh &mesh, const Transform &renderFromObject, Float maxEdge,
                      const Displacement &displacement);

inline constexpr size_t kMaxDisplacedTriangles = size_t(1) << 25;

/// Size of the input surface, in rendering space.
struct SplitSize {
    double faces = 0, area = 0, edges = 0;  ///< number of triangles; sums of their areas and of their longest edges
    /// Estimated number of triangles after splitting.
    double Triangles(double maxEdge) const;
};
SplitSize MeasureSplit(const PlyMesh &mesh, const Transform &renderFromObject);

}  // namespace pbrt
