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

    /// A segment; the exit points are where surfaces cross it.
    struct Probe {
        Point3 from, to;
    };
    /// Draws an axis, a wavelength whose profile gives the radius, and a line parallel to the axis at that radius. The
    /// line is cut off at the sphere around p inside which 99.9 % of the light comes out; the rest is lost, as in
    /// stock. Empty if nothing comes out.
    std::optional<Probe> SampleProbe(Float uc, const Point2 &u) const;
    /// Density, by area, of an exit point with geometric normal n, before one of the crossings of the probe is chosen.
    Float Pdf(const Point3 &exit, const Normal3 &n) const;
    /// The share of the light that comes out per area at this distance from p.
    SampledSpectrum Profile(Float distance) const;
    NormalizedFresnelBxdf ExitLobe() const { return {table_->Eta(), table_->ExitScale()}; }

  private:
    std::array<SubsurfaceTable::Row, SpectrumSamples> rows_;
    const SubsurfaceTable *table_;
    Point3 p_;
    Frame frame_;  ///< z along the shading normal
    SampledSpectrum sigmaT_, reach_;
    int wavelengths_;  ///< number of wavelengths that are drawn from: only the first, or all
};

}  // namespace pbrt
