#pragma once
#include <optional>
#include <span>
#include <vector>

#include "pbrt/cameras/aperture_image.h"
#include "pbrt/math/ray.h"

namespace pbrt {

/// A line of a lens file, in metres. Elements are listed from scene to film.
struct LensElement {
    Float curvatureRadius = 0;  ///< above 0: convex towards the scene; 0: an aperture stop
    Float thickness = 0;        ///< distance to the next element or the film
    Float index = 1;            ///< refractive index between this element and the next
    Float apertureRadius = 0;
    bool IsStop() const { return curvatureRadius == 0; }
};

/// Reads a lens file (pbrt-v4-format §15). Throws UserError (no location).
std::vector<LensElement> ReadLensFile(const std::string &path);

/// Paraxial optics of a lens in air, metres.
struct CardinalPoints {
    double focalLength = 0;     ///< infinite or NaN for an afocal lens
    double rearPrincipal = 0;   ///< from the last element's vertex towards the scene
    double frontPrincipal = 0;  ///< from the first element's vertex towards the film
};
CardinalPoints ComputeCardinalPoints(std::span<const LensElement> elements);

/// Distance from the last element to the film that focuses the plane at `distance` from the film, for small angles.
/// Empty if there is none.
std::optional<double> FocusedThickness(std::span<const LensElement> elements, double distance);

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
