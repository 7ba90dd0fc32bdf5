#pragma once
#include <memory>

#include "pbrt/images/image.h"
#include "pbrt/shapes/surface_point.h"

namespace pbrt {

/// Image of shading normals: RGB = (n + 1) / 2 with x along dpdu and z along the shading normal. Repeats; v = 0 is the
/// bottom row.
class NormalMap {
  public:
    explicit NormalMap(std::shared_ptr<const Image> image) : image_(std::move(image)) {}
    /// Rotates the shading frame to the mapped normal. dpdu and dpdv stay orthogonal to it and keep their lengths.
    void Perturb(SurfacePoint &point) const;

  private:
    std::shared_ptr<const Image> image_;  ///< R, G, B
};

}  // namespace pbrt
