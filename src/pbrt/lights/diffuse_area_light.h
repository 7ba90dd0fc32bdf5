#pragma once
#include <span>
#include <vector>

#include "pbrt/images/image.h"
#include "pbrt/lights/light.h"
#include "pbrt/lights/light_factory.h"
#include "pbrt/lights/light_image.h"
#include "pbrt/math/frame.h"
#include "pbrt/math/warps.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// Emission of one AreaLightSource directive, shared by all its lights: a spectrum, or an image over (u, v), v upwards.
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
    void Summarise() {
        averageOfRange = Average(SampledWavelengths::WholeRange());
        if (spectrum) {
            peak = spectrum->MaxValue();
            luminance = 1;
            return;
        }
        Rgb weights = colorSpace->Luminance();
        double values = 0, luminances = 0;
        const Point2i n = image.Resolution();
        ForEachPixel(image, [&](Point2i p) {
            const Rgb rgb = LightPixel(image, p);
            values += double(MeanOf(rgb));
            luminances += double(glm::dot(rgb, weights));
        });
        double pixels = double(n.x) * double(n.y);
        peak = Float(values / pixels);
        luminance = Float(luminances / pixels);
    }
    /// Mean radiance over (u, v), before scale.
    SampledSpectrum Average(const SampledWavelengths &lambda) const {
        return spectrum ? spectrum->Sample(lambda) : AverageIlluminant(image, *colorSpace, lambda);
    }
    SampledSpectrum Radiance(const Point2 &uv, const SampledWavelengths &lambda) const {
        if (spectrum) return spectrum->Sample(lambda);
        Point2 st(uv.x, 1 - uv.y);
        Rgb rgb;
        for (int c = 0; c < 3; ++c) rgb[c] = std::max(image.Bilinear(st, c, WrapMode::Clamp), Float(0));
        return RgbIlluminant(*colorSpace, rgb, lambda);
    }
};

/// Light from the shapes of one Shape directive, whose primitives are its components. Emits uniform radiance in all
/// directions of the emitting side(s).
class DiffuseAreaLight final : public Light {
  public:
    /// With a constant alpha of 0, rays cannot hit the light: its kind is DeltaPosition, for light sampling only.
    DiffuseAreaLight(std::shared_ptr<const AreaEmission> emission, std::span<const Shape *const> shapes,
                     const FloatTexture *alpha)
        : Light(IsInvisible(alpha) ? LightKind::DeltaPosition : LightKind::Area), emission_(std::move(emission)),
          shapes_(shapes.begin(), shapes.end()), alpha_(IsInvisible(alpha) ? nullptr : alpha) {
        for (const Shape *shape : shapes) componentCount_ += shape->PrimitiveCount();
    }

    uint32_t ComponentCount() const override { return componentCount_; }
    ShapePrimitive Surface(uint32_t component) const override {
        if (shapes_.size() == 1) return {shapes_[0], component};
        size_t s = 0;
        while (component >= shapes_[s]->PrimitiveCount()) component -= shapes_[s++]->PrimitiveCount();
        return {shapes_[s], component};
    }

    LightPower Phi(const SampledWavelengths &lambda, uint32_t component) const override {
        const ShapePrimitive at = Surface(component);
        return {PowerPerRadiance(at), lambda.IsWholeRange() ? emission_->averageOfRange : emission_->Average(lambda)};
    }
    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool, uint32_t component) const override {
        const ShapePrimitive at = Surface(component);
        std::optional<ShapeSample> point = at.shape->Sample(at.primitive, from, u);
        if (!point || !(point->pdf > 0)) return {};
        Vector3 d = point->p - from.p;
        Float d2 = LengthSquared(d);
        if (!(d2 > 0)) return {};
        Vector3 wi = d / std::sqrt(d2);
        if (!EmitsTowards(point->n, -wi)) return {};
        Float coverage = Coverage(point->p, point->uv);
        if (!(coverage > 0)) return {};
        const SampledSpectrum L = (Scale(at) * coverage) * emission_->Radiance(point->uv, lambda);
        if (!L) return {};
        return LightLiSample{L, wi, point->pdf, point->p, point->pError, point->n};
    }
    Float PdfLi(const LightSampleContext &from, const Vector3 &wi, const Point3 &pHit, const Normal3 &nHit, bool,
                uint32_t component) const override {
        if (Kind() != LightKind::Area) return 0;
        const ShapePrimitive at = Surface(component);
        return at.shape->PdfSolidAngle(at.primitive, from, wi, pHit, nHit);
    }
    /// Positions by the shape's SampleArea, directions by cosine; both sides equally if both emit.
    std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                          const SampledWavelengths &lambda, uint32_t component) const override {
        const ShapePrimitive at = Surface(component);
        const std::optional<ShapeSample> point = at.shape->SampleArea(at.primitive, uPosition);
        if (!point || !(point->pdf > 0)) return {};
        const Float coverage = Coverage(point->p, point->uv);
        if (!(coverage > 0)) return {};
        Point2 u = uDirection;
        Normal3 side = point->n;
        if (emission_->twoSided) {
            const bool front = u.x < Float(0.5);
            if (!front) side = -side;
            u.x = std::min(2 * u.x - (front ? 0 : 1), OneMinusEpsilon);
        }
        const Vector3 local = SampleCosineHemisphere(u);
        const Float pdfDirection = CosineHemispherePdf(local.z) / (emission_->twoSided ? 2 : 1);
        if (!(pdfDirection > 0)) return {};
        const SampledSpectrum L = (Scale(at) * coverage) * emission_->Radiance(point->uv, lambda);
        if (!L) return {};
        const Vector3 d = Frame::FromZ(side).FromLocal(local);
        const Ray ray{.o = OffsetRayOrigin(point->p, point->pError, point->n, d), .d = d};
        return LightLeSample{L, ray, point->p, point->pError, point->n, point->uv, point->pdf, pdfDirection};
    }
    LightLePdf PdfLe(const Point3 &p, const Normal3 &n, const Vector3 &w, uint32_t component) const override {
        const ShapePrimitive at = Surface(component);
        const Float cosine = emission_->twoSided ? AbsDot(n, w) / 2 : std::max(Dot(n, w), Float(0));
        return {at.shape->PdfArea(at.primitive, p, n), CosineHemispherePdf(cosine)};
    }
    /// Radiance of a point hit by a ray. Alpha is not applied again, as it has already stopped the ray.
    SampledSpectrum L(const Point3 &, const Normal3 &n, const Point2 &uv, const Vector3 &w,
                      const SampledWavelengths &lambda, uint32_t component) const override {
        if (!EmitsTowards(n, w)) return SampledSpectrum(0);
        return Scale(Surface(component)) * emission_->Radiance(uv, lambda);
    }
    std::optional<LightBounds> Bounds(uint32_t component) const override {
        const ShapePrimitive at = Surface(component);
        const double phi = double(emission_->peak) * PowerPerRadiance(at);
        if (!(phi > 0)) return {};
        DirectionCone normals = at.shape->NormalBounds(at.primitive);
        return LightBounds{
            at.shape->PrimitiveBounds(at.primitive), normals.w, phi, normals.cosTheta, 0, emission_->twoSided};
    }

  private:
    static bool IsInvisible(const FloatTexture *alpha) { return alpha && alpha->Constant() == Float(0); }

    /// Probability that the surface stops a ray at a point. Light samples are weighted by it and rays are stopped with
    /// it (Accel), so both have the same expected value.
    Float Coverage(const Point3 &p, const Point2 &uv) const {
        if (!alpha_) return 1;
        TextureContext at;  // the fields that alpha tests set
        at.p = p;
        at.uv = uv;
        return std::clamp(alpha_->Evaluate(at), Float(0), Float(1));
    }
    bool EmitsTowards(const Normal3 &n, const Vector3 &w) const { return emission_->twoSided || !(Dot(n, w) < 0); }

    /// Emission scale. If a power is given, every primitive has it.
    Float Scale(const ShapePrimitive &at) const {
        if (!(emission_->power > 0)) return emission_->scale;
        const Float area = at.shape->Area(at.primitive);
        const double emitted =
            double(emission_->luminance) * double(area) * std::numbers::pi * (emission_->twoSided ? 2 : 1);
        return emitted > 0 ? Float(double(emission_->scale) * double(emission_->power) / emitted) : 0;
    }
    /// Power of a primitive with emission 1 before scale.
    double PowerPerRadiance(const ShapePrimitive &at) const {
        return double(Scale(at)) * double(at.shape->Area(at.primitive)) * std::numbers::pi *
               (emission_->twoSided ? 2 : 1);
    }

    std::shared_ptr<const AreaEmission> emission_;
    std::vector<const Shape *> shapes_;
    const FloatTexture *alpha_;
    uint32_t componentCount_ = 0;
};

}  // namespace pbrt
