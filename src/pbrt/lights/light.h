#pragma once
#include <memory>
#include <optional>

#include "pbrt/lights/light_bounds.h"
#include "pbrt/math/ray.h"
#include "pbrt/shapes/shape.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

class EnvironmentLight;
class EnvironmentPortals;

/// How a light can be found: delta lights only by SampleLi, the others also by rays that hit them (area) or leave the
/// scene (infinite).
enum class LightKind { DeltaPosition, DeltaDirection, Area, Infinite };
constexpr bool IsDelta(LightKind k) { return k == LightKind::DeltaPosition || k == LightKind::DeltaDirection; }

/// The point at which light arrives. Normals are zero in a medium.
using LightSampleContext = ShapeSampleContext;

/// Light arriving from one drawn direction.
struct LightLiSample {
    SampledSpectrum L;  ///< radiance (or intensity over distance squared, irradiance for delta lights)
    Vector3 wi{};       ///< unit, towards the light
    Float pdf = 0;      ///< solid angle; 1 for delta lights
    Point3 pLight{};    ///< end of the shadow segment
    Vector3 pLightError{};
    Normal3 nLight{};  ///< zero where the light has no surface
};

/// A ray along which light leaves a light. Its flux is L / (pdfPosition * pdfDirection), times the cosine at the normal
/// where there is one.
struct LightLeSample {
    SampledSpectrum L;       ///< radiance; lights at a point: intensity; distant lights: irradiance
    Ray ray;                 ///< unit direction; lights beyond the scene: starts outside of its bounding sphere
    Point3 p{};              ///< the point of the surface that the ray leaves, before it was moved off it
    Vector3 pError{};        ///< of p
    Normal3 n{};             ///< of the surface that the ray leaves; zero where there is none
    Point2 uv{};             ///< on that surface
    Float pdfPosition = 0;   ///< area: of the surface, or across the ray for lights beyond the scene; 1 for points
    Float pdfDirection = 0;  ///< solid angle; 1 for distant lights
};

/// Densities of SampleLe, in the same measures; 0 for what is 1 there because it is certain.
struct LightLePdf {
    Float position = 0, direction = 0;
};

/// Emitted power: `factor` times `spectrum`, whose product may lie beyond single precision.
struct LightPower {
    double factor = 0;
    SampledSpectrum spectrum;
    double Average() const {
        double sum = 0;
        for (int i = 0; i < SpectrumSamples; ++i) sum += double(spectrum[i]);
        return factor * sum / SpectrumSamples;
    }
};

/// One primitive of a shape.
struct ShapePrimitive {
    const Shape *shape = nullptr;
    uint32_t primitive = 0;
};

/// A light. Immutable once the scene is built. Spectral values at a path's wavelengths.
///
/// A light may have components: the primitives of an emissive mesh. Each can be chosen alone and has a LightId, so the
/// functions take the index of a component. Other lights have one component and ignore `component`.
class Light {
  public:
    explicit Light(LightKind kind) : kind_(kind) {}
    virtual ~Light() = default;
    LightKind Kind() const { return kind_; }
    virtual uint32_t ComponentCount() const { return 1; }

    /// Emitted power (W-like, photometric scaling as in pbrt), at these wavelengths. Infinite lights: over the disk of
    /// the scene's bounding sphere; needs Preprocess.
    virtual LightPower Phi(const SampledWavelengths &lambda, uint32_t component = 0) const = 0;

    /// `allowIncompletePdfs`: infinite lights may leave out directions of little light; only for callers that combine
    /// this with BSDF sampling by MIS.
    virtual std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                                  const SampledWavelengths &lambda, bool allowIncompletePdfs,
                                                  uint32_t component = 0) const = 0;

    /// Solid-angle density of SampleLi(from) for direction wi. Area lights: the ray from `from` along wi hits this
    /// component at pHit with normal nHit; infinite lights ignore these. 0 for delta lights.
    virtual Float PdfLi(const LightSampleContext &from, const Vector3 &wi, const Point3 &pHit, const Normal3 &nHit,
                        bool allowIncompletePdfs, uint32_t component = 0) const = 0;

    /// A ray that leaves the light, drawn nearly in proportion to the flux; by two independent points of the unit
    /// square. Lights beyond the scene need Preprocess. Empty where no light leaves.
    virtual std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                                  const SampledWavelengths &lambda, uint32_t component = 0) const = 0;
    /// Densities of SampleLe for a ray through p along w (unit). Area lights: p lies on this component, with normal n;
    /// others ignore n.
    virtual LightLePdf PdfLe(const Point3 &p, const Normal3 &n, const Vector3 &w, uint32_t component = 0) const = 0;

    /// Area lights: radiance leaving p in direction w (unit). 0 for others.
    virtual SampledSpectrum L(const Point3 &p, const Normal3 &n, const Point2 &uv, const Vector3 &w,
                              const SampledWavelengths &lambda, uint32_t component = 0) const {
        (void)p;
        (void)n;
        (void)uv;
        (void)w;
        (void)lambda;
        (void)component;
        return SampledSpectrum(0);
    }
    /// Infinite lights: radiance arriving along a ray that leaves the scene from o in direction d. 0 for others.
    virtual SampledSpectrum Le(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda) const {
        (void)o;
        (void)d;
        (void)lambda;
        return SampledSpectrum(0);
    }

    /// What a spatial light sampler needs, by the largest value of the spectrum; empty for infinite lights and lights
    /// without power.
    virtual std::optional<LightBounds> Bounds(uint32_t component = 0) const {
        (void)component;
        return {};
    }
    /// The surface that a component shines from; without a shape where there is none.
    virtual ShapePrimitive Surface(uint32_t component = 0) const {
        (void)component;
        return {};
    }
    /// This light if it is an environment light; else null.
    virtual const EnvironmentLight *AsEnvironment() const { return nullptr; }

    /// Gives the light the bounding sphere of the whole scene. Called once, before use.
    virtual void Preprocess(const Point3 &sceneCenter, Float sceneRadius) {
        (void)sceneCenter;
        (void)sceneRadius;
    }

  private:
    LightKind kind_;
};

/// Directions of an environment light that a light sampler samples in a way of its own: one of the regions of its
/// portals. Default: all directions.
struct EnvironmentRegion {
    const EnvironmentPortals *portals = nullptr;
    uint32_t index = 0;
    bool operator==(const EnvironmentRegion &) const = default;
};

/// A component of a light, identified by a LightId. See Light for the functions.
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
    SampledSpectrum Le(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda) const {
        return light_->Le(o, d, lambda);
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
