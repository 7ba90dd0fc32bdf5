#pragma once
#include <memory>
#include <vector>

#include "pbrt/math/catmull_rom.h"

namespace pbrt {

/// Integral of Fresnel's reflectance times cos^power over cosines in [0, 1], for light that arrives from inside
/// (`eta` as in FresnelDielectric).
Float InnerFresnelMoment(Float eta, int power);

/// The light that a scattering half space sends back at distance r from where a thin beam enters perpendicularly:
/// photon beam diffusion with single scattering (Habel, Christensen, Jarosz 2013), tabulated as splines over the
/// single-scattering albedo and the radius in mean free paths.
class SubsurfaceTable {
  public:
    /// -1 < g < 1: mean cosine of the scattering; eta > 0: index of refraction.
    SubsurfaceTable(Float g, Float eta);
    /// A table that all callers with the same g and eta share; it is freed with its last owner.
    static std::shared_ptr<const SubsurfaceTable> Shared(Float g, Float eta);

    /// The table at one albedo.
    struct Row {
        SplineWeights albedo;
        Float reflectance = 0;  ///< share of the light that comes back: the profile integrated over the plane
    };
    Row AtAlbedo(Float albedo) const;

    /// Share of the light per area, in units of the mean free path squared, at a radius in mean free paths; 0 beyond
    /// the table (about 200 mean free paths).
    Float Profile(const Row &row, Float radius) const;
    /// Draws a radius with density 2 pi r Profile(r) / reflectance.
    Float SampleRadius(const Row &row, Float u) const;
    /// The single-scattering albedo that gives this reflectance; 1 if no albedo reflects so much.
    Float AlbedoOf(Float reflectance) const;

    Float Eta() const { return eta_; }
    /// 1 / (pi times the mean transmittance of the surface for light from outside): normalises the exit lobe.
    Float ExitScale() const { return exitScale_; }

  private:
    Float Interpolate(const std::vector<Float> &table, const SplineWeights &albedo, int radius) const;

    Float eta_, exitScale_;
    std::vector<Float> albedos_, radii_;
    std::vector<Float> profile_, cdf_;  ///< 2 pi r times the profile and its running integral; by albedo, then radius
    std::vector<Float> reflectances_;   ///< by albedo
};

}  // namespace pbrt
