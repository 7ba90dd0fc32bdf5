#pragma once
#include <vector>

#include "pbrt/cameras/lens_system.h"
#include "pbrt/math/bounds.h"

namespace pbrt {

/// Per film point, a rectangle in the plane z = lens.RearZ() that bounds all light reaching it. Metres.
class ExitPupil {
  public:
    /// `lens` must have round stops. `filmRadius`: radius of the film's bounding circle.
    ExitPupil(const LensSystem &lens, Float filmRadius);

    /// Rectangle for film points on the positive x axis at this distance from the axis.
    const Bounds2 &Bounds(Float distance) const;

    /// Samples the film point's rectangle uniformly.
    Point2 Sample(const Point2 &film, const Point2 &u) const;
    /// Density of Sample for that film point, by area.
    Float Pdf(const Point2 &film) const { return 1 / Bounds(glm::length(film)).Area(); }

  private:
    Float filmRadius_;
    std::vector<Bounds2> bounds_;  ///< per equal step of the distance from the axis
};

}  // namespace pbrt
