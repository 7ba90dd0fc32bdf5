#pragma once
#include <span>
#include <vector>

#include "pbrt/cameras/aperture_image.h"
#include "pbrt/cameras/lens_file.h"
#include "pbrt/math/ray.h"

namespace pbrt {

/// Spherical surfaces and stops around the z axis: film at z = 0, scene towards +z. Metres.
class LensSystem {
  public:
    /// `elements`: from scene to film, the last thickness reaching the film. A non-empty `aperture` replaces the stops'
    /// round holes.
    explicit LensSystem(std::span<const LensElement> elements, const ApertureImage &aperture = {});

    Float RearZ() const { return surfaces_.front().z; }  ///< vertex of the rear element
    Float FrontZ() const { return surfaces_.back().z; }  ///< vertex of the front element
    Float RearRadius() const { return surfaces_.front().apertureRadius; }

    /// Traces a ray from behind the lens (d unit, towards +z) to the front. Returns the fraction of light that passes;
    /// if 0, the ray is undefined.
    Float Trace(Ray *ray) const;

  private:
    struct Surface {
        Float curvature;  ///< 1 / radius, above 0 convex towards the scene; 0: a stop
        Float z;          ///< of the vertex
        Float apertureRadius;
        Float relativeIndex;  ///< before over behind, along the ray
    };
    std::vector<Surface> surfaces_;  ///< from the film to the scene
    ApertureImage aperture_;
};

}  // namespace pbrt
