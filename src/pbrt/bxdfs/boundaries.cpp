#include "pbrt/bxdfs/boundaries.h"

#include "pbrt/bxdfs/fresnel.h"

namespace pbrt {
namespace {

/// Probability of sampling reflection, from both fractions of light and the requested sides. Negative: neither.
Float ReflectionProbability(Float reflectance, Float transmittance, ReflTransFlags which) {
    if (!Has(which, ReflTransFlags::Reflection)) return transmittance > 0 ? 0 : -1;
    if (!Has(which, ReflTransFlags::Transmission)) return reflectance > 0 ? 1 : -1;
    return reflectance / (reflectance + transmittance);
}

/// Jacobian d(wm) / d(wi) of refraction (Walter et al. 2007, eq. 17).
Float RefractionJacobian(Float cosO, Float cosI, Float etaRelative) {
    return std::abs(cosI) / Sqr(cosI + cosO / etaRelative);
}

/// Radiance is scaled with the solid angle at a boundary; importance is not.
Float TransportScale(TransportMode mode, Float etaRelative) {
    return mode == TransportMode::Radiance ? 1 / Sqr(etaRelative) : 1;
}

}  // namespace

bool DielectricBxdf::FacetBetween(const Vector3 &wo, const Vector3 &wi, bool reflect, Vector3 *wm,
                                  Float *etaRelative) const {
    if (wo.z == 0 || wi.z == 0) return false;
    *etaRelative = reflect ? 1 : (wo.z > 0 ? eta_ : 1 / eta_);
    Vector3 h = wi * *etaRelative + wo;
    Float length2 = LengthSquared(h);
    if (length2 == 0) return false;
    h /= std::copysign(std::sqrt(length2), h.z);
    *wm = h;
    // Rejects facets seen from behind by either direction.
    return Dot(h, wi) * wi.z >= 0 && Dot(h, wo) * wo.z >= 0;
}

SampledSpectrum DielectricBxdf::F(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const {
    if (IsSmooth()) return SampledSpectrum(0);
    bool reflect = SameHemisphere(wo, wi);
    Vector3 wm;
    Float etaRelative;
    if (!FacetBetween(wo, wi, reflect, &wm, &etaRelative)) return SampledSpectrum(0);
    Float cosO = Dot(wo, wm), cosI = Dot(wi, wm);
    Float fresnel = FresnelDielectric(cosO, eta_);
    Float facets = facets_.D(wm) * facets_.G(wo, wi) / std::abs(wo.z * wi.z);
    if (reflect) return SampledSpectrum(facets * fresnel / 4);
    Float refraction = std::abs(cosO) * RefractionJacobian(cosO, cosI, etaRelative);
    return SampledSpectrum(facets * (1 - fresnel) * refraction * TransportScale(mode, etaRelative));
}

Float DielectricBxdf::Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode, ReflTransFlags which) const {
    if (IsSmooth()) return 0;
    bool reflect = SameHemisphere(wo, wi);
    Vector3 wm;
    Float etaRelative;
    if (!FacetBetween(wo, wi, reflect, &wm, &etaRelative)) return 0;
    Float cosO = Dot(wo, wm), cosI = Dot(wi, wm);
    Float fresnel = FresnelDielectric(cosO, eta_);
    Float pReflect = ReflectionProbability(fresnel, 1 - fresnel, which);
    if (pReflect < 0) return 0;
    Float pdfNormal = facets_.G1(wo) * facets_.D(wm) / AbsCosTheta(wo);  // without |wo . wm|
    if (reflect) return pdfNormal / 4 * pReflect;
    return pdfNormal * std::abs(cosO) * RefractionJacobian(cosO, cosI, etaRelative) * (1 - pReflect);
}

std::optional<BsdfSample> DielectricBxdf::SampleSmooth(const Vector3 &wo, Float uc, TransportMode mode,
                                                       ReflTransFlags which) const {
    Float fresnel = FresnelDielectric(CosTheta(wo), eta_);
    Float pReflect = ReflectionProbability(fresnel, 1 - fresnel, which);
    if (pReflect < 0) return {};
    if (uc < pReflect)
        return BsdfSample{SampledSpectrum(fresnel / AbsCosTheta(wo)), Vector3(-wo.x, -wo.y, wo.z), pReflect,
                          BxdfFlags::Reflection | BxdfFlags::Specular};
    Vector3 wi;
    Float etaRelative;
    if (!Refract(wo, Normal3(0, 0, 1), eta_, &etaRelative, &wi)) return {};
    Float transmitted = (1 - fresnel) * TransportScale(mode, etaRelative);
    return BsdfSample{SampledSpectrum(transmitted / AbsCosTheta(wi)), wi, 1 - pReflect,
                      BxdfFlags::Transmission | BxdfFlags::Specular, etaRelative};
}

std::optional<BsdfSample> DielectricBxdf::Sample(const Vector3 &wo, Float uc, const Point2 &u, TransportMode mode,
                                                 ReflTransFlags which) const {
    if (wo.z == 0) return {};
    if (IsSmooth()) return SampleSmooth(wo, uc, mode, which);
    Vector3 wm = facets_.SampleVisible(wo, u);
    Float cosO = Dot(wo, wm);
    Float fresnel = FresnelDielectric(cosO, eta_);
    Float pReflect = ReflectionProbability(fresnel, 1 - fresnel, which);
    if (pReflect < 0) return {};
    Float d = facets_.D(wm);
    Float pdfNormal = facets_.G1(wo) * d / AbsCosTheta(wo);  // without |wo . wm|
    if (uc < pReflect) {
        Vector3 wi = Reflect(wo, wm);
        if (!SameHemisphere(wo, wi)) return {};
        Float f = d * facets_.G(wo, wi) * fresnel / (4 * wo.z * wi.z);
        return BsdfSample{SampledSpectrum(f), wi, pdfNormal / 4 * pReflect, BxdfFlags::Reflection | BxdfFlags::Glossy};
    }
    Vector3 wi;
    Float etaRelative;
    if (!Refract(wo, wm, eta_, &etaRelative, &wi) || wo.z * wi.z >= 0) return {};
    Float refraction = std::abs(cosO) * RefractionJacobian(cosO, Dot(wi, wm), etaRelative);
    Float f = d * facets_.G(wo, wi) * (1 - fresnel) * refraction / std::abs(wo.z * wi.z);
    return BsdfSample{SampledSpectrum(f * TransportScale(mode, etaRelative)), wi,
                      pdfNormal * refraction * (1 - pReflect), BxdfFlags::Transmission | BxdfFlags::Glossy,
                      etaRelative};
}

DielectricBxdf::Facet DielectricBxdf::DrawFacet(const Vector3 &wo, const Point2 &u) const {
    Facet facet;
    facet.wm = IsSmooth() ? Vector3(0, 0, 1) : facets_.SampleVisibleByCap(wo, u);
    facet.cosine = Dot(wo, facet.wm);
    facet.eta = eta_;
    if (facet.cosine < 0) {
        facet.wm = -facet.wm;
        facet.cosine = -facet.cosine;
        facet.eta = 1 / eta_;
    }
    facet.cosine = std::min(facet.cosine, Float(1));
    facet.fresnel = FresnelDielectric(facet.cosine, facet.eta, &facet.cosT);
    return facet;
}

DielectricBxdf::Drawn DielectricBxdf::DrawReflection(const Vector3 &wo, const Point2 &u) const {
    const Facet facet = DrawFacet(wo, u);
    if (IsSmooth()) return {Vector3(-wo.x, -wo.y, wo.z), facet.fresnel};
    const Vector3 wi = facet.wm * (2 * facet.cosine) - wo;
    if (!SameHemisphere(wo, wi)) return {};
    return {wi, facet.fresnel * facets_.GOverG1(wo, wi)};
}

DielectricBxdf::Drawn DielectricBxdf::DrawTransmission(const Vector3 &wo, const Point2 &u, TransportMode mode) const {
    const Facet facet = DrawFacet(wo, u);
    if (!(facet.fresnel < 1)) return {};
    const Vector3 wi = facet.Refracted(wo);
    if (!(wo.z * wi.z < 0)) return {};
    const Float transmitted = (1 - facet.fresnel) * TransportScale(mode, facet.eta);
    if (IsSmooth()) return {wi, transmitted, 1, true};
    const Float refraction = facet.cosine * RefractionJacobian(facet.cosine, -facet.cosT, facet.eta);
    const Float pdf = facets_.G1(wo) * facets_.D(facet.wm) / AbsCosTheta(wo) * refraction;
    return {wi, transmitted * facets_.GOverG1(wo, wi), pdf, true};
}

DielectricBxdf::Drawn DielectricBxdf::DrawEither(const Vector3 &wo, Float uc, const Point2 &u,
                                                 TransportMode mode) const {
    // Both sides are sampled by their fraction of the light, so the Fresnel term cancels, too.
    const Facet facet = DrawFacet(wo, u);
    if (uc < facet.fresnel) {
        if (IsSmooth()) return {Vector3(-wo.x, -wo.y, wo.z), 1};
        const Vector3 wi = facet.wm * (2 * facet.cosine) - wo;
        if (!SameHemisphere(wo, wi)) return {};
        return {wi, facets_.GOverG1(wo, wi)};
    }
    if (!(facet.fresnel < 1)) return {};
    const Vector3 wi = facet.Refracted(wo);
    if (!(wo.z * wi.z < 0)) return {};
    const Float scale = TransportScale(mode, facet.eta);
    return {wi, IsSmooth() ? scale : scale * facets_.GOverG1(wo, wi), 0, true};
}

DielectricBxdf::Transmission DielectricBxdf::EvaluateTransmission(const Vector3 &wo, const Vector3 &wi,
                                                                  TransportMode mode) const {
    Vector3 wm;
    Float etaRelative;
    if (!FacetBetween(wo, wi, false, &wm, &etaRelative)) return {};
    const Float cosO = Dot(wo, wm), cosI = Dot(wi, wm);
    const Float transmittance = 1 - FresnelDielectric(cosO, eta_);
    if (!(transmittance > 0)) return {};
    const Float common = facets_.D(wm) / AbsCosTheta(wo) * std::abs(cosO) * RefractionJacobian(cosO, cosI, etaRelative);
    const Float f = common * facets_.G(wo, wi) / AbsCosTheta(wi) * transmittance * TransportScale(mode, etaRelative);
    return {f, common * facets_.G1(wo)};
}

std::optional<BsdfSample> ThinDielectricBxdf::Sample(const Vector3 &wo, Float uc, const Point2 &, TransportMode) const {
    Float cosine = AbsCosTheta(wo);
    if (cosine == 0) return {};
    Float r = FresnelDielectric(cosine, eta_), t = 1 - r;
    if (r < 1) {  // r + t r t + t r^3 t + ...
        r += t * t * r / (1 - r * r);
        t = 1 - r;
    }
    const Float pReflect = r / (r + t);
    if (uc < pReflect)
        return BsdfSample{SampledSpectrum(r / cosine), Vector3(-wo.x, -wo.y, wo.z), pReflect,
                          BxdfFlags::Reflection | BxdfFlags::Specular};
    return BsdfSample{SampledSpectrum(t / cosine), -wo, 1 - pReflect, BxdfFlags::Transmission | BxdfFlags::Specular};
}

SampledSpectrum ConductorBxdf::F(const Vector3 &wo, const Vector3 &wi, TransportMode) const {
    if (!SameHemisphere(wo, wi) || facets_.EffectivelySmooth()) return SampledSpectrum(0);
    Vector3 wm = Normalize(wo + wi);
    Float facets = facets_.D(wm) * facets_.G(wo, wi) / (4 * wo.z * wi.z);
    return FresnelConductor(AbsDot(wo, wm), eta_, k_) * facets;
}

std::optional<BsdfSample> ConductorBxdf::Sample(const Vector3 &wo, Float, const Point2 &u, TransportMode) const {
    if (wo.z == 0) return {};
    if (facets_.EffectivelySmooth()) {
        Float cosine = AbsCosTheta(wo);
        return BsdfSample{FresnelConductor(cosine, eta_, k_) / cosine, Vector3(-wo.x, -wo.y, wo.z), 1,
                          BxdfFlags::Reflection | BxdfFlags::Specular};
    }
    Vector3 wm = facets_.SampleVisible(wo, u);
    Vector3 wi = Reflect(wo, wm);
    if (!SameHemisphere(wo, wi)) return {};
    Float d = facets_.D(wm);
    Float pdf = facets_.G1(wo) * d / (4 * AbsCosTheta(wo));
    Float facets = d * facets_.G(wo, wi) / (4 * wo.z * wi.z);
    return BsdfSample{FresnelConductor(AbsDot(wo, wm), eta_, k_) * facets, wi, pdf,
                      BxdfFlags::Reflection | BxdfFlags::Glossy};
}

Float ConductorBxdf::Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode) const {
    if (!SameHemisphere(wo, wi) || facets_.EffectivelySmooth()) return 0;
    // Half-vector density times Jacobian 1 / (4 |wo . wm|).
    return facets_.G1(wo) * facets_.D(Normalize(wo + wi)) / (4 * AbsCosTheta(wo));
}

}  // namespace pbrt
