#pragma once
#include <functional>

#include "pbrt/core/error.h"
#include "pbrt/shapes/ply.h"

namespace pbrt {

/// How a mesh is displaced.
struct Displacement {
    /// Object units along the normal; the position and the (unit) normal are given in rendering space.
    std::function<Float(const Point3 &p, const Normal3 &n, const Point2 &uv)> height;
    Float edgeScale = 1;  ///< multiplies "edgelength"
};

/// A mesh that cannot be displaced (no location), and the parameter of the shape that is the reason.
class DisplacementError : public UserError {
  public:
    DisplacementError(const char *parameter, std::string message)
        : UserError(std::move(message)), parameter_(parameter) {}
    const char *Parameter() const { return parameter_; }

  private:
    const char *parameter_;  ///< "displacement" or "edgelength"
};

/// Splits triangles and quads at the middle of their longest edges until all edges are shorter than `maxEdge` in
/// rendering space, then moves the vertices along their normals and gives them new normals, on the side of the old
/// ones. Faces that share vertices keep doing so: no cracks. The result is in object space. Throws DisplacementError if
/// texture coordinates or normals are missing, or there would be more than kMaxDisplacedTriangles; nearly always before
/// the work is done.
MeshData DisplaceMesh(const PlyMesh &mesh, const Transform &renderFromObject, Float maxEdge,
                      const Displacement &displacement);

inline constexpr size_t kMaxDisplacedTriangles = size_t(1) << 25;

/// Size of the surface that is to be split, in rendering space.
struct SplitSize {
    double faces = 0, area = 0, edges = 0;  ///< number of triangles; sums of their areas and of their longest edges
    /// An estimate of the number of triangles after the split.
    double Triangles(double maxEdge) const;
};
SplitSize MeasureSplit(const PlyMesh &mesh, const Transform &renderFromObject);

}  // namespace pbrt
