#pragma once
#include <vector>

#include "pbrt/cameras/lens_system.h"
#include "pbrt/math/bounds.h"

namespace pbrt {

/// For each point of the film a rectangle in the plane z = lens.RearZ() that holds every point through which light of
/// the scene reaches it. Metres.
class ExitPupil {
  public:
    /// `lens` must have round stops. `filmRadius` is the radius of the circle around the film.
    ExitPupil(const LensSystem &lens, Float filmRadius);

    /// The rectangle for film points at this distance from the axis, on the positive x axis.
    const Bounds2 &Bounds(Float distance) const;

    /// A point in the plane, uniform over the rectangle of the film point.
    Point2 Sample(const Point2 &film, const Point2 &u) const;
    /// Density over area of Sample for that film point.
    Float Pdf(const Point2 &film) const { return 1 / Bounds(glm::length(film)).Area(); }

  private:
    Float filmRadius_;
    std::vector<Bounds2> bounds_;  ///< one for each of equal steps of the distance from the axis
};

}  // namespace pbrt
