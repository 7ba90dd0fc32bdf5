#pragma once
#include <span>
#include <vector>

#include "pbrt/images/image.h"
#include "pbrt/lights/light.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// Emission of one AreaLightSource directive, shared by the lights of all its shapes: a spectrum, or an image over (u,
/// v), v upwards.
struct AreaEmission {
    std::shared_ptr<const DenseSpectrum> spectrum;  ///< null if there is an image
    Image image;                                    ///< R, G, B
    const ColorSpace *colorSpace = nullptr;         ///< of the image
    bool twoSided = false;
    Float scale = 1;                 ///< includes the photometric normalisation, not `power`
    Float power = -1;                ///< if positive, the power of each primitive
    Float peak = 0;                  ///< maximum of the spectrum; mean of all image values
    Float luminance = 1;             ///< mean luminance of the image; 1 for a spectrum
    SampledSpectrum averageOfRange;  ///< mean radiance at SampledWavelengths::WholeRange(), before scale

    /// Computes peak, luminance and averageOfRange.
    void Summarise();
    /// Mean radiance over (u, v), before scale.
    SampledSpectrum Average(const SampledWavelengths &lambda) const;
    SampledSpectrum Radiance(const Point2 &uv, const SampledWavelengths &lambda) const;
};

/// Light from the shapes of one Shape directive, whose primitives are its components. Emits uniform radiance in all
/// directions of the emitting side(s).
class DiffuseAreaLight final : public Light {
  public:
    /// A constant alpha of 0 makes a light that rays cannot hit: its kind is DeltaPosition, so only light sampling
    /// reaches it.
    DiffuseAreaLight(std::shared_ptr<const AreaEmission> emission, std::span<const Shape *const> shapes,
                     const FloatTexture *alpha);

    uint32_t ComponentCount() const override { return componentCount_; }
    ShapePrimitive Surface(uint32_t component) const override {
        if (shapes_.size() == 1) return {shapes_[0], component};
        size_t s = 0;
        while (component >= shapes_[s]->PrimitiveCount()) component -= shapes_[s++]->PrimitiveCount();
        return {shapes_[s], component};
    }

    LightPower Phi(const SampledWavelengths &lambda, uint32_t component) const override;
    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool allowIncompletePdfs,
                                          uint32_t component) const override;
    Float PdfLi(const LightSampleContext &from, const Vector3 &wi, const Point3 &pHit, const Normal3 &nHit,
                bool allowIncompletePdfs, uint32_t component) const override;
    /// Positions by the shape's SampleArea, directions by cosine; both sides equally if both emit.
    std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                          const SampledWavelengths &lambda, uint32_t component) const override;
    LightLePdf PdfLe(const Point3 &p, const Normal3 &n, const Vector3 &w, uint32_t component) const override;
    /// Radiance of a point hit by a ray. Alpha is not applied again, as it has already stopped the ray.
    SampledSpectrum L(const Point3 &p, const Normal3 &n, const Point2 &uv, const Vector3 &w,
                      const SampledWavelengths &lambda, uint32_t component) const override;
    std::optional<LightBounds> Bounds(uint32_t component) const override;

  private:
    /// Probability that the surface stops a ray at a point. Light samples are weighted by it and rays are stopped with
    /// it (Accel), so both have the same expected value.
    Float Coverage(const Point3 &p, const Point2 &uv) const;
    bool EmitsTowards(const Normal3 &n, const Vector3 &w) const { return emission_->twoSided || !(Dot(n, w) < 0); }

    /// Emission scale. If a power is given, every primitive has it.
    Float Scale(const ShapePrimitive &at) const { return emission_->power > 0 ? ScaleForPower(at) : emission_->scale; }
    Float ScaleForPower(const ShapePrimitive &at) const;
    /// Power of a primitive with emission 1 before scale.
    double PowerPerRadiance(const ShapePrimitive &at) const;

    std::shared_ptr<const AreaEmission> emission_;
    std::vector<const Shape *> shapes_;
    const FloatTexture *alpha_;
    uint32_t componentCount_ = 0;
};

}  // namespace pbrt
