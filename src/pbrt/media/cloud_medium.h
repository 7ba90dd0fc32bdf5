#pragma once
#include "pbrt/media/medium_spectra.h"

namespace pbrt {

/// Box with a procedural cloud of density at most 1. The density is a function of medium space, where the cloud lies
/// between y = 0 and y = 1.
class CloudMedium final : public Medium {
  public:
    struct Shape {
        Float density = 1, wispiness = 1, frequency = 5;
        Float DensityAt(const Point3 &p) const;
    };
    /// Spectra at density 1; the emission must be 0.
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
