#pragma once
#include <optional>

#include "pbrt/lights/light_bounds.h"
#include "pbrt/math/ray.h"
#include "pbrt/shapes/shape.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

class EnvironmentLight;
class EnvironmentPortals;

/// Delta lights are reached only by SampleLi, others also by rays that hit them (area) or leave the scene (infinite).
enum class LightKind { DeltaPosition, DeltaDirection, Area, Infinite };
constexpr bool IsDelta(LightKind k) { return k == LightKind::DeltaPosition || k == LightKind::DeltaDirection; }

/// Receiving point. Normals are zero in a medium.
using LightSampleContext = ShapeSampleContext;

/// Incident light from one sampled direction.
struct LightLiSample {
    SampledSpectrum L;  ///< radiance (or intensity over distance squared, irradiance for delta lights)
    Vector3 wi{};       ///< unit, towards the light
    Float pdf = 0;      ///< solid angle; 1 for delta lights
    Point3 pLight{};    ///< end of the shadow segment
    Vector3 pLightError{};
    Normal3 nLight{};  ///< zero where the light has no surface
};

/// Emitted ray. Its flux is L / (pdfPosition * pdfDirection), times the cosine at the normal if there is one.
struct LightLeSample {
    SampledSpectrum L;       ///< radiance; lights at a point: intensity; distant lights: irradiance
    Ray ray;                 ///< unit direction; lights outside the scene: starts outside its bounding sphere
    Point3 p{};              ///< surface point, before the offset of the ray origin
    Vector3 pError{};        ///< of p
    Normal3 n{};             ///< of the surface; zero if there is none
    Point2 uv{};             ///< on that surface
    Float pdfPosition = 0;   ///< area: on the surface, or across the ray for lights outside the scene; 1 for points
    Float pdfDirection = 0;  ///< solid angle; 1 for distant lights
};

/// Densities of SampleLe, in the same measures; 0 where SampleLe's value is a certain 1.
struct LightLePdf {
    Float position = 0, direction = 0;
};

/// Emitted power: `factor` times `spectrum`, whose product may exceed single precision.
struct LightPower {
    double factor = 0;
    SampledSpectrum spectrum;
    double Average() const {
        double sum = 0;
        for (int i = 0; i < SpectrumSamples; ++i) sum += double(spectrum[i]);
        return factor * sum / SpectrumSamples;
    }
};

struct ShapePrimitive {
    const Shape *shape = nullptr;
    uint32_t primitive = 0;
};

/// A light; immutable once the scene is built. Spectral values are at a path's wavelengths.
///
/// The primitives of an emissive mesh are components of one light. Each has a LightId and can be selected alone, so
/// functions take a component index. Other lights have one component and ignore `component`.
class Light {
  public:
    explicit Light(LightKind kind) : kind_(kind) {}
    virtual ~Light() = default;
    LightKind Kind() const { return kind_; }
    virtual uint32_t ComponentCount() const { return 1; }

    /// Emitted power (W, with pbrt's photometric scaling) at these wavelengths. Infinite lights: over the disk of the
    /// scene's bounding sphere; requires Preprocess.
    virtual LightPower Phi(const SampledWavelengths &lambda, uint32_t component = 0) const = 0;

    /// `allowIncompletePdfs`: infinite lights may omit directions of little light; only with MIS and BSDF sampling.
    virtual std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                                  const SampledWavelengths &lambda, bool allowIncompletePdfs,
                                                  uint32_t component = 0) const = 0;

    /// Solid-angle density of SampleLi(from) for direction wi; 0 for delta lights. Area lights: the ray hits this
    /// component at pHit with normal nHit; infinite lights ignore these.
    virtual Float PdfLi(const LightSampleContext &, const Vector3 & /*wi*/, const Point3 & /*pHit*/,
                        const Normal3 & /*nHit*/, bool /*allowIncompletePdfs*/, uint32_t /*component*/ = 0) const {
        return 0;
    }

    /// Samples an emitted ray, nearly in proportion to flux, from two independent points of the unit square. Lights
    /// outside the scene require Preprocess. Empty where no light leaves.
    virtual std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                                  const SampledWavelengths &lambda, uint32_t component = 0) const = 0;
    /// Densities of SampleLe for a ray through p along w (unit). Area lights: p is on it, with normal n; others ignore
    /// n.
    virtual LightLePdf PdfLe(const Point3 &p, const Normal3 &n, const Vector3 &w, uint32_t component = 0) const = 0;

    /// Area lights: radiance leaving p in direction w (unit). Others: 0.
    virtual SampledSpectrum L(const Point3 & /*p*/, const Normal3 & /*n*/, const Point2 & /*uv*/, const Vector3 & /*w*/,
                              const SampledWavelengths &, uint32_t /*component*/ = 0) const {
        return SampledSpectrum(0);
    }
    /// Infinite lights: radiance along a ray that leaves the scene from o in direction d. Others: 0.
    virtual SampledSpectrum Le(const Point3 & /*o*/, const Vector3 & /*d*/, const SampledWavelengths &) const {
        return SampledSpectrum(0);
    }

    /// Bounds for spatial light samplers, by the maximum of the spectrum; empty for infinite and black lights.
    virtual std::optional<LightBounds> Bounds(uint32_t /*component*/ = 0) const { return {}; }
    /// Emitting surface of a component; without shape if there is none.
    virtual ShapePrimitive Surface(uint32_t /*component*/ = 0) const { return {}; }
    virtual const EnvironmentLight *AsEnvironment() const { return nullptr; }

    /// Sets the scene's bounding sphere. Called once, before use.
    virtual void Preprocess(const Point3 & /*sceneCenter*/, Float /*sceneRadius*/) {}

  private:
    LightKind kind_;
};

/// Directions of an environment light that a light sampler samples separately: a region of portals. Default: all.
struct EnvironmentRegion {
    const EnvironmentPortals *portals = nullptr;
    uint32_t index = 0;
    bool operator==(const EnvironmentRegion &) const = default;
};

/// A light component, identified by a LightId; forwards to Light.
class LightComponent {
  public:
    LightComponent(const Light &light, uint32_t component, EnvironmentRegion region = {})
        : light_(&light), component_(component), region_(region) {}
    LightKind Kind() const { return light_->Kind(); }
    LightPower Phi(const SampledWavelengths &lambda) const { return light_->Phi(lambda, component_); }
    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool allowIncompletePdfs) const {
        if (region_.portals) [[unlikely]]
            return SampleRegion(from, u, lambda, allowIncompletePdfs);
        return light_->SampleLi(from, u, lambda, allowIncompletePdfs, component_);
    }
    Float PdfLi(const LightSampleContext &from, const Vector3 &wi, const Point3 &pHit, const Normal3 &nHit,
                bool allowIncompletePdfs) const {
        if (region_.portals) [[unlikely]]
            return RegionPdf(from, wi, allowIncompletePdfs);
        return light_->PdfLi(from, wi, pHit, nHit, allowIncompletePdfs, component_);
    }
    std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                          const SampledWavelengths &lambda) const {
        return light_->SampleLe(uPosition, uDirection, lambda, component_);
    }
    LightLePdf PdfLe(const Point3 &p, const Normal3 &n, const Vector3 &w) const {
        return light_->PdfLe(p, n, w, component_);
    }
    SampledSpectrum L(const Point3 &p, const Normal3 &n, const Point2 &uv, const Vector3 &w,
                      const SampledWavelengths &lambda) const {
        return light_->L(p, n, uv, w, lambda, component_);
    }
    std::optional<LightBounds> Bounds() const { return light_->Bounds(component_); }
    ShapePrimitive Surface() const { return light_->Surface(component_); }
    const Light &Parent() const { return *light_; }

  private:
    std::optional<LightLiSample> SampleRegion(const LightSampleContext &from, const Point2 &u,
                                              const SampledWavelengths &lambda, bool allowIncompletePdfs) const;
    Float RegionPdf(const LightSampleContext &from, const Vector3 &wi, bool allowIncompletePdfs) const;

    const Light *light_;
    uint32_t component_;
    EnvironmentRegion region_;
};

}  // namespace pbrt
