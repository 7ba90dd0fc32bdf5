#pragma once
#include <span>
#include <vector>

#include "pbrt/images/image.h"
#include "pbrt/lights/light.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// The emission that one AreaLightSource directive describes; shared by the lights of all shapes it applies to. Either
/// a spectrum or an image over (u, v), v upwards.
struct AreaEmission {
    std::shared_ptr<const DenseSpectrum> spectrum;  ///< null if there is an image
    Image image;                                    ///< R, G, B
    const ColorSpace *colorSpace = nullptr;         ///< of the image
    bool twoSided = false;
    Float scale = 1;                 ///< includes the photometric normalisation, not `power`
    Float power = -1;                ///< if positive, what each primitive shall emit
    Float peak = 0;                  ///< largest spectrum value; mean of all image values
    Float luminance = 1;             ///< mean luminance of the image; 1 for a spectrum
    SampledSpectrum averageOfRange;  ///< mean radiance at SampledWavelengths::WholeRange(), before scale

    /// Fills peak, luminance and averageOfRange from the rest.
    void Summarise();
    /// Mean radiance over (u, v), before scale.
    SampledSpectrum Average(const SampledWavelengths &lambda) const;
    SampledSpectrum Radiance(const Point2 &uv, const SampledWavelengths &lambda) const;
};

/// Light from the shapes of one Shape directive; their primitives are its components. The radiance is the same in all
/// directions of the side(s) that emit.
class DiffuseAreaLight final : public Light {
  public:
    /// A constant alpha of 0 makes a light that rays cannot hit: its kind is DeltaPosition, so that only light sampling
    /// finds it.
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
    /// Points as SampleArea of the shape draws them, directions by the cosine; both sides alike if both emit.
    std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                          const SampledWavelengths &lambda, uint32_t component) const override;
    LightLePdf PdfLe(const Point3 &p, const Normal3 &n, const Vector3 &w, uint32_t component) const override;
    /// Radiance of a point that a ray has hit. The alpha texture is not applied again: it has decided that the ray
    /// stops there.
    SampledSpectrum L(const Point3 &p, const Normal3 &n, const Point2 &uv, const Vector3 &w,
                      const SampledWavelengths &lambda, uint32_t component) const override;
    std::optional<LightBounds> Bounds(uint32_t component) const override;

  private:
    /// The share of rays that the surface stops at a point. Light samples are weighted by it; rays are stopped that
    /// often (Accel), so that both have the same expected value.
    Float Coverage(const Point3 &p, const Point2 &uv) const;
    bool EmitsTowards(const Normal3 &n, const Vector3 &w) const { return emission_->twoSided || !(Dot(n, w) < 0); }

    /// The factor of the emission. If a power is given, it is the power of every primitive.
    Float Scale(const ShapePrimitive &at) const { return emission_->power > 0 ? ScaleForPower(at) : emission_->scale; }
    Float ScaleForPower(const ShapePrimitive &at) const;
    /// The power of a primitive whose emission is 1 before scale.
    double PowerPerRadiance(const ShapePrimitive &at) const;

    std::shared_ptr<const AreaEmission> emission_;
    std::vector<const Shape *> shapes_;
    const FloatTexture *alpha_;
    uint32_t componentCount_ = 0;
};

}  // namespace pbrt
