#pragma once
#include <vector>

#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/math/exponential.h"
#include "pbrt/media/medium.h"
#include "pbrt/media/segment_distance.h"

namespace pbrt {

class LightTable;

/// A stretch of a ray in a medium that is the same all along it.
struct MediumStretch {
    Ray ray;
    Float tMax = 0;             ///< may be infinite
    MediumCoefficients medium;  ///< per unit of length
    Float meanExtinction = 0;   ///< of the path's wavelengths

    /// Transmittance times scattering, per unit of length: the density with which delta tracking scatters at t.
    SampledSpectrum ScatteringAt(Float t) const {
        const SampledSpectrum transmittance =
            (medium.absorption + medium.scattering).Map([t](Float sigma) { return ExpOfMinus(sigma * t); });
        return transmittance * medium.scattering;
    }
};

/// How a place on a stretch is drawn once the light is chosen that shall shine there: by equiangular sampling about the
/// middle of the light, or in proportion to transmittance, each half of the time; only the latter for lights without a
/// place.
class SegmentDistances {
  public:
    /// The lights must be finished.
    explicit SegmentDistances(const LightTable &lights);

    /// A distance and its density per unit of length. Density 0: there is none.
    struct Sample {
        Float t = 0, pdf = 0;
    };
    Sample Draw(const MediumStretch &stretch, LightId light, Float u) const;
    Float Pdf(const MediumStretch &stretch, LightId light, Float t) const;

  private:
    struct Place {
        Point3 center{};
        Float radius = -1;  ///< below 0: the light has no place
    };
    const Place *PlaceOf(LightId light) const;
    std::vector<Place> places_;
};

}  // namespace pbrt
