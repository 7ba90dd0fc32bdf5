#pragma once
#include <memory>

#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/bxdfs/bssrdf.h"
#include "pbrt/shapes/shape.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

class Material {
  public:
    virtual ~Material() = default;

    /// BSDF at a point whose shading frame is final. May terminate secondary wavelengths (dispersion).
    virtual Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const = 0;

    virtual void PerturbShading(SurfacePoint &) const {}  ///< applies a normal or bump map to the shading frame

    /// For mix: the material chosen by a hash of p, wo and the two operands. Others: themselves; null: interface.
    virtual const Material *Resolve(const SurfacePoint &) const { return this; }

    virtual bool HasBssrdf() const { return false; }
    /// BSSRDF at this point; empty without subsurface scattering.
    virtual std::optional<Bssrdf> GetBssrdf(const SurfacePoint &, const SampledWavelengths &) const { return {}; }

    virtual bool IsInterface() const { return false; }  ///< no scattering, only a boundary of media
    virtual bool IsMix() const { return false; }
    /// True if GetBsdf suffices: Resolve returns this, PerturbShading does nothing, and the material is no interface.
    bool IsPlain() const { return isPlain_; }

    /// True if a texture of the material or of its operands uses the filter footprint.
    bool NeedsFootprint() const { return needsFootprint_; }
    void SetNeedsFootprint(bool needs) { needsFootprint_ = needs; }

  protected:
    void SetPlain(bool plain) { isPlain_ = plain; }

  private:
    bool needsFootprint_ = false, isPlain_ = false;
};
using MaterialPtr = std::shared_ptr<const Material>;

}  // namespace pbrt
