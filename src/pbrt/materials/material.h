#pragma once
#include <memory>

#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/bxdfs/bssrdf.h"
#include "pbrt/shapes/surface_point.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// Turns textures at a surface point into a BSDF.
class Material {
  public:
    virtual ~Material() = default;

    /// The BSDF at a point whose shading frame is final. May terminate secondary wavelengths (dispersion).
    virtual Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const = 0;

    /// Applies normal map or bump map to the shading frame.
    virtual void PerturbShading(SurfacePoint &) const {}

    /// For mix: the material chosen at this point by a hash of p, wo and the two operands. All others return
    /// themselves. nullptr means "interface": nothing scatters.
    virtual const Material *Resolve(const SurfacePoint &) const { return this; }

    /// True for materials that scatter light below their surface.
    virtual bool HasBssrdf() const { return false; }
    /// Where light that crosses the surface at this point comes out again; empty if light is not scattered below the
    /// surface.
    virtual std::optional<Bssrdf> GetBssrdf(const SurfacePoint &, const SampledWavelengths &) const { return {}; }

    /// True for interface.
    virtual bool IsInterface() const { return false; }
    /// True if Resolve returns this, PerturbShading does nothing and the material is no interface: GetBsdf is all.
    bool IsPlain() const { return isPlain_; }

    /// True if a texture of the material, or of those that it mixes, uses the point's filter footprint.
    bool NeedsFootprint() const { return needsFootprint_; }
    void SetNeedsFootprint(bool needs) { needsFootprint_ = needs; }

  protected:
    void SetPlain(bool plain) { isPlain_ = plain; }

  private:
    bool needsFootprint_ = false, isPlain_ = false;
};
using MaterialPtr = std::shared_ptr<const Material>;

}  // namespace pbrt
