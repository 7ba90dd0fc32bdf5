#pragma once
#include "pbrt/media/medium_spectra.h"

namespace pbrt {

class HomogeneousMedium final : public Medium {
  public:
    HomogeneousMedium(MediumSpectra spectra, Float g)
        : Medium(g, spectra.emission.MaxValue() > 0 && spectra.absorption.MaxValue() > 0),
          spectra_(std::move(spectra)) {}
    size_t Bytes() const override { return sizeof(*this) + spectra_.Bytes(); }
    MediumOnRay On(const Ray &, Float tMax, const SampledWavelengths &lambda) const override {
        const MediumCoefficients c = spectra_.Sample(lambda);
        return {*this, GridWalk(tMax), lambda, c, c.absorption + c.scattering};
    }

  private:
    MediumCoefficients Evaluate(MediumOnRay &onRay, Float) const override { return onRay.Unit(); }
    MediumSpectra spectra_;
};

}  // namespace pbrt
