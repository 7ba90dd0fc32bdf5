#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/math/catmull_rom.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// Integral of Fresnel reflectance times cos^power over cosines in [0, 1], from inside (`eta`: see FresnelDielectric).
Float InnerFresnelMoment(Float eta, int power);

/// Radial diffusion profile of a half space for a perpendicular beam: photon beam diffusion with single scattering
/// (Habel, Christensen, Jarosz 2013), tabulated as splines over single-scattering albedo and radius in mean free paths.
class SubsurfaceTable {
  public:
    /// Integrates the profiles. -1 < g < 1: mean cosine; eta > 0: index of refraction.
    static SubsurfaceTable Compute(Float g, Float eta);
    /// Shared table of these arguments, freed with its last owner.
    static std::shared_ptr<const SubsurfaceTable> Shared(Float g, Float eta);

    struct Row {
        SplineWeights albedo;
        Float reflectance = 0;  ///< total exiting fraction: the profile integrated over the plane
    };
    Row AtAlbedo(Float albedo) const;

    /// Exiting fraction per area, in squared mean free paths, at a radius in mean free paths; 0 beyond some 200.
    Float Profile(const Row &row, Float radius) const;
    /// Samples a radius with density 2 pi r Profile(r) / reflectance.
    Float SampleRadius(const Row &row, Float u) const;
    /// Single-scattering albedo of this reflectance; 1 if none reaches it.
    Float AlbedoOf(Float reflectance) const;

    Float Eta() const { return eta_; }
    /// 1 / (pi times the surface's mean transmittance from outside): normalises the exit lobe.
    Float ExitScale() const { return exitScale_; }

  private:
    explicit SubsurfaceTable(Float eta);
    Float Interpolate(const std::vector<Float> &table, const SplineWeights &albedo, int radius) const;

    Float eta_, exitScale_;
    std::vector<Float> albedos_, radii_;
    std::vector<Float> profile_, cdf_;  ///< 2 pi r times the profile and its running integral; by albedo, then radius
    std::vector<Float> reflectances_;   ///< by albedo
};

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
