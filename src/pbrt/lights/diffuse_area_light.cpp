#include "pbrt/lights/diffuse_area_light.h"

#include "pbrt/lights/light_image.h"
#include "pbrt/lights/light_spectrum.h"

namespace pbrt {

void AreaEmission::Summarise() {
    averageForPower = Average(PowerWavelengths());
    if (spectrum) {
        peak = spectrum->MaxValue();
        luminance = 1;
        return;
    }
    Rgb weights = colorSpace->Luminance();
    double values = 0, luminances = 0;
    Point2i n = image.Resolution();
    for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) {
            Rgb rgb = LightPixel(image, {x, y});
            values += static_cast<double>((rgb.x + rgb.y + rgb.z) / 3);
            luminances += static_cast<double>(glm::dot(rgb, weights));
        }
    double pixels = static_cast<double>(n.x) * static_cast<double>(n.y);
    peak = static_cast<Float>(values / pixels);
    luminance = static_cast<Float>(luminances / pixels);
}

SampledSpectrum AreaEmission::Average(const SampledWavelengths &lambda) const {
    return spectrum ? spectrum->Sample(lambda) : AverageIlluminant(image, *colorSpace, lambda);
}

SampledSpectrum AreaEmission::Radiance(const Point2 &uv, const SampledWavelengths &lambda) const {
    if (spectrum) return spectrum->Sample(lambda);
    Point2 st(uv.x, 1 - uv.y);
    Rgb rgb;
    for (int c = 0; c < 3; ++c) rgb[c] = std::max(image.Bilinear(st, c, WrapMode::Clamp), Float(0));
    return RgbIlluminantSpectrum(*colorSpace, rgb).Sample(lambda);
}

namespace {

bool IsInvisible(const FloatTexture *alpha) {
    if (!alpha) return false;
    std::optional<Float> constant = alpha->Constant();
    return constant && *constant == 0;
}

}  // namespace

DiffuseAreaLight::DiffuseAreaLight(std::shared_ptr<const AreaEmission> emission, const Shape &shape, uint32_t primitive,
                                   const FloatTexture *alpha)
    : Light(IsInvisible(alpha) ? LightKind::DeltaPosition : LightKind::Area),
      emission_(std::move(emission)),
      shape_(&shape),
      alpha_(IsInvisible(alpha) ? nullptr : alpha),
      primitive_(primitive),
      area_(shape.Area(primitive)),
      scale_(emission_->scale) {
    if (emission_->power > 0) {
        Float emitted = emission_->luminance * area_ * Pi * (emission_->twoSided ? 2 : 1);
        scale_ = emitted > 0 ? scale_ * emission_->power / emitted : 0;
    }
}

Float DiffuseAreaLight::Coverage(const Point3 &p, const Point2 &uv) const {
    if (!alpha_) return 1;
    TextureContext at;  // what a ray's alpha test fills in
    at.p = p;
    at.uv = uv;
    return std::clamp(alpha_->Evaluate(at), Float(0), Float(1));
}

SampledSpectrum DiffuseAreaLight::Phi(const SampledWavelengths &lambda) const {
    static const SampledWavelengths kPower = PowerWavelengths();
    bool known = true;
    for (int i = 0; i < SpectrumSamples; ++i) known &= lambda[i] == kPower[i];
    SampledSpectrum average = known ? emission_->averageForPower : emission_->Average(lambda);
    return average * (scale_ * Pi * area_ * (emission_->twoSided ? 2 : 1));
}

std::optional<LightLiSample> DiffuseAreaLight::SampleLi(const LightSampleContext &from, const Point2 &u,
                                                        const SampledWavelengths &lambda, bool) const {
    std::optional<ShapeSample> point = shape_->Sample(primitive_, from, u);
    if (!point || !(point->pdf > 0)) return {};
    Vector3 d = point->p - from.p;
    Float d2 = LengthSquared(d);
    if (!(d2 > 0)) return {};
    Vector3 wi = d / std::sqrt(d2);
    if (!EmitsTowards(point->n, -wi)) return {};
    Float coverage = Coverage(point->p, point->uv);
    if (!(coverage > 0)) return {};
    LightLiSample s;
    s.L = (scale_ * coverage) * emission_->Radiance(point->uv, lambda);
    if (!s.L) return {};
    s.wi = wi;
    s.pdf = point->pdf;
    s.pLight = point->p;
    s.pLightError = point->pError;
    s.nLight = point->n;
    return s;
}

Float DiffuseAreaLight::PdfLi(const LightSampleContext &from, const Vector3 &wi, const Point3 &pHit,
                              const Normal3 &nHit, bool) const {
    if (Kind() != LightKind::Area) return 0;
    return shape_->PdfSolidAngle(primitive_, from, wi, pHit, nHit);
}

SampledSpectrum DiffuseAreaLight::L(const Point3 &, const Normal3 &n, const Point2 &uv, const Vector3 &w,
                                    const SampledWavelengths &lambda) const {
    if (!EmitsTowards(n, w)) return SampledSpectrum(0);
    return scale_ * emission_->Radiance(uv, lambda);
}

std::optional<LightBounds> DiffuseAreaLight::Bounds() const {
    Float phi = emission_->peak * scale_ * area_ * Pi * (emission_->twoSided ? 2 : 1);
    if (!(phi > 0)) return {};
    DirectionCone normals = shape_->NormalBounds(primitive_);
    return LightBounds{shape_->PrimitiveBounds(primitive_), normals.w, phi, normals.cosTheta, 0, emission_->twoSided};
}

}  // namespace pbrt
