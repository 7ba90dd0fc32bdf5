#pragma once
#include <array>
#include <optional>

#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/bxdfs/subsurface_table.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// Separable BSSRDF at p: the surface's transmittance at p (part of the BSDF), a radial profile, and an exit lobe.
/// Lives on the stack; the table must outlive it.
class Bssrdf {
  public:
    /// `ns`: shading normal at p. `sigmaA`, `sigmaS` per unit length, >= 0.
    Bssrdf(const Point3 &p, const Normal3 &ns, const SampledSpectrum &sigmaA, const SampledSpectrum &sigmaS,
           const SampledWavelengths &lambda, const SubsurfaceTable &table);

    /// Segment whose surface crossings are the exit points.
    struct Probe {
        Point3 from, to;
    };
    /// Samples an axis, a radius by the profile of one wavelength, and a line parallel to the axis at that radius. The
    /// line is clipped to the sphere around p that contains 99.9 % of the exiting light; as in stock, the rest is lost.
    /// Empty if no light exits.
    std::optional<Probe> SampleProbe(Float uc, const Point2 &u) const;
    /// Density, by area, of an exit point with geometric normal n, before one of the probe's crossings is chosen.
    Float Pdf(const Point3 &exit, const Normal3 &n) const;
    /// Fraction of the light that exits per area at this distance from p.
    SampledSpectrum Profile(Float distance) const;
    NormalizedFresnelBxdf ExitLobe() const { return {table_->Eta(), table_->ExitScale()}; }

  private:
    std::array<SubsurfaceTable::Row, SpectrumSamples> rows_;
    const SubsurfaceTable *table_;
    Point3 p_;
    Frame frame_;  ///< z is the shading normal
    SampledSpectrum sigmaT_, reach_;
    int wavelengths_;  ///< number of sampled wavelengths: only the first, or all
};

}  // namespace pbrt
