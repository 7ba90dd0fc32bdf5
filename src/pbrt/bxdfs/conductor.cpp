#include "pbrt/bxdfs/conductor.h"

#include "pbrt/bxdfs/fresnel.h"

namespace pbrt {

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
