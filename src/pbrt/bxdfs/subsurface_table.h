#pragma once
#include <memory>
#include <vector>

#include "pbrt/math/catmull_rom.h"

namespace pbrt {

/// Integral of Fresnel reflectance times cos^power over cosines in [0, 1], for light from inside (`eta` as in
/// FresnelDielectric).
Float InnerFresnelMoment(Float eta, int power);

/// Radial diffusion profile of a half space for a perpendicular beam: photon beam diffusion with single scattering
/// (Habel, Christensen, Jarosz 2013), tabulated as splines over single-scattering albedo and radius in mean free paths.
class SubsurfaceTable {
  public:
    /// -1 < g < 1: mean cosine; eta > 0: index of refraction.
    SubsurfaceTable(Float g, Float eta);
    /// Shared table of these arguments, freed with its last owner.
    static std::shared_ptr<const SubsurfaceTable> Shared(Float g, Float eta);

    struct Row {
        SplineWeights albedo;
        Float reflectance = 0;  ///< total exiting fraction: the profile integrated over the plane
    };
    Row AtAlbedo(Float albedo) const;

    /// Exiting fraction per area, in squared mean free paths, at a radius in mean free paths; 0 beyond the table (about
    /// 200).
    Float Profile(const Row &row, Float radius) const;
    /// Samples a radius with density 2 pi r Profile(r) / reflectance.
    Float SampleRadius(const Row &row, Float u) const;
    /// Single-scattering albedo of this reflectance; 1 if none reaches it.
    Float AlbedoOf(Float reflectance) const;

    Float Eta() const { return eta_; }
    /// 1 / (pi times the surface's mean transmittance from outside): normalises the exit lobe.
    Float ExitScale() const { return exitScale_; }

  private:
    Float Interpolate(const std::vector<Float> &table, const SplineWeights &albedo, int radius) const;

    Float eta_, exitScale_;
    std::vector<Float> albedos_, radii_;
    std::vector<Float> profile_, cdf_;  ///< 2 pi r times the profile and its running integral; by albedo, then radius
    std::vector<Float> reflectances_;   ///< by albedo
};

}  // namespace pbrt
