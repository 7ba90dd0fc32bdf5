#pragma once
#include <optional>
#include <span>
#include <vector>

#include "pbrt/core/files.h"
#include "pbrt/images/image.h"
#include "pbrt/math/ray.h"

namespace pbrt {

/// Transmittance over an aperture stop, scaled to the total of an open disk.
class ApertureImage {
  public:
    /// Empty: a disk.
    ApertureImage() = default;
    /// `image`: one channel, >= 0, not all black; row 0 is the bottom (-y).
    explicit ApertureImage(Image image);

    /// Built-in shape or image file `name`; empty if the name is empty. Throws UserError (no location).
    static ApertureImage Read(const std::string &name, const FileResolver &files);

    explicit operator bool() const { return bool(image_); }
    /// `p` in units of the stop's radius; 0 outside [-1, 1]^2.
    Float Lookup(const Point2 &p) const { return image_.Bilinear((p + Point2(1)) / Float(2), 0, WrapMode::Black); }
    /// Largest radius that passes light, in units of the stop's radius.
    Float Reach() const { return reach_; }

  private:
    Image image_;
    Float reach_ = 1;
};

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
