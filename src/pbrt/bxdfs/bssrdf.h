#pragma once
#include <array>
#include <optional>

#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/bxdfs/subsurface_table.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// Where light that crosses the surface at p comes out again. Separable: the surface's transmittance at p (the BSDF's
/// part), a profile of the distance between the two points, and an exit lobe. A value on the stack; the table must
/// outlive it.
class Bssrdf {
  public:
    /// `ns`: shading normal at p. `sigmaA`, `sigmaS` per unit length, not negative.
    Bssrdf(const Point3 &p, const Normal3 &ns, const SampledSpectrum &sigmaA, const SampledSpectrum &sigmaS,
           const SampledWavelengths &lambda, const SubsurfaceTable &table);

    /// Exit points lie on surfaces that cross this segment.
    struct Probe {
        Point3 from, to;
    };
    /// Draws an axis, a wavelength whose profile gives the radius, and a line along the axis at that radius, cut off
    /// where 1/1000 of the light is left (which is lost, as in stock). Empty if nothing comes out.
    std::optional<Probe> SampleProbe(Float uc, const Point2 &u) const;
    /// Density, by area, of an exit point with geometric normal n, if all crossings of the probe count.
    Float Pdf(const Point3 &exit, const Normal3 &n) const;
    /// Light per area of the exit, by distance from p.
    SampledSpectrum Profile(Float distance) const;
    NormalizedFresnelBxdf ExitLobe() const { return {table_->Eta(), table_->ExitScale()}; }

  private:
    std::array<SubsurfaceTable::Row, SpectrumSamples> rows_;
    const SubsurfaceTable *table_;
    Point3 p_;
    Frame frame_;  ///< z along the shading normal
    SampledSpectrum sigmaT_, reach_;
    int wavelengths_;  ///< that are drawn from: the first ones
};

}  // namespace pbrt
