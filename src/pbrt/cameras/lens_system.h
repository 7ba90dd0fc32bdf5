#pragma once
#include <span>
#include <vector>

#include "pbrt/cameras/aperture_image.h"
#include "pbrt/cameras/lens_file.h"
#include "pbrt/math/ray.h"

namespace pbrt {

/// A stack of spherical surfaces and stops around the z axis: the film is in the plane z = 0, the scene in front of the
/// lens, towards +z. Metres.
class LensSystem {
  public:
    /// `elements`: from the scene to the film, the last thickness reaching to the film. `aperture`, if it is not empty,
    /// takes the place of the stops' round holes.
    explicit LensSystem(std::span<const LensElement> elements, const ApertureImage &aperture = {});

    Float RearZ() const { return surfaces_.front().z; }  ///< vertex of the element next to the film
    Float FrontZ() const { return surfaces_.back().z; }  ///< vertex of the element next to the scene
    Float RearRadius() const { return surfaces_.front().apertureRadius; }

    /// Takes a ray from behind the lens (d unit, towards +z) to where it leaves the lens. Returns the share of light
    /// that passes; if it is 0, the ray has no meaning.
    Float Trace(Ray *ray) const;

  private:
    struct Surface {
        Float curvature;  ///< 1 / radius, above 0 convex towards the scene; 0: a stop
        Float z;          ///< of the vertex
        Float apertureRadius;
        Float relativeIndex;  ///< before over behind, seen along the ray
    };
    std::vector<Surface> surfaces_;  ///< from the film to the scene
    ApertureImage aperture_;
};

}  // namespace pbrt
