#pragma once
#include "pbrt/media/medium_spectra.h"

namespace pbrt {

/// A box with a cloud of noise in it, whose density is at most 1. Coordinates of the density are those of the medium's
/// own space, in which the cloud lies between y = 0 and y = 1.
class CloudMedium final : public Medium {
  public:
    struct Shape {
        Float density = 1, wispiness = 1, frequency = 5;
        /// The density at a place of the medium's space.
        Float DensityAt(const Point3 &p) const;
    };
    /// The spectra are those at density 1; the emission must be 0.
    CloudMedium(MediumSpectra spectra, Float g, const Transform &renderFromMedium, const Bounds3 &bounds,
                const Shape &shape);
    size_t Bytes() const override { return sizeof(*this) + spectra_.Bytes() + majorants_.Bytes(); }
    MediumOnRay On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const override;

  private:
    MediumCoefficients Evaluate(MediumOnRay &onRay, Float t) const override;

    MediumSpectra spectra_;
    Shape shape_;
    Bounds3 bounds_;
    MajorantGrid majorants_;
    AffineMap gridFromRender_;
};

}  // namespace pbrt
