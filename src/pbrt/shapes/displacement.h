#pragma once
#include <functional>

#include "pbrt/core/error.h"
#include "pbrt/shapes/mesh_sources.h"

namespace pbrt {

struct Displacement {
    /// Displacement along the normal in object units; position and (unit) normal are in rendering space.
    std::function<Float(const Point3 &p, const Normal3 &n, const Point2 &uv)> height;
    Float edgeScale = 1;  ///< multiplies "edgelength"
};

/// Displacement failure (no location) with the responsible parameter of the shape.
class DisplacementError : public UserError {
  public:
    DisplacementError(const char *parameter, std::string message)
        : UserError(std::move(message)), parameter_(parameter) {}
    const char *Parameter() const { return parameter_; }

  private:
    const char *parameter_;  ///< "displacement" or "edgelength"
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
