#pragma once
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// Unpolarised reflectance of a smooth dielectric boundary; 1 under total internal reflection. `cosI`: in [0, 1];
/// `eta`: index on the far side over the near side. `cosT` gets the cosine of the refracted direction, if there is one.
inline Float FresnelDielectric(Float cosI, Float eta, Float *cosT) {
    const Float sin2T = (1 - cosI * cosI) / (eta * eta);
    if (!(sin2T < 1)) return 1;
    *cosT = std::sqrt(1 - sin2T);
    const Float parallel = (eta * cosI - *cosT) / (eta * cosI + *cosT);
    const Float perpendicular = (cosI - eta * *cosT) / (cosI + eta * *cosT);
    return (parallel * parallel + perpendicular * perpendicular) / 2;
}

/// The same for `eta`, the index below (z < 0) over the index above; negative cosThetaI: light from below.
inline Float FresnelDielectric(Float cosThetaI, Float eta) {
    Float cosT;
    return FresnelDielectric(std::min(std::abs(cosThetaI), Float(1)), cosThetaI < 0 ? 1 / eta : eta, &cosT);
}

/// Unpolarised reflectance of complex relative index eta + i k (Born and Wolf, Principles of Optics, 14.2). Sums of
/// squares only, so that cancellation cannot leave [0, 1].
inline Float FresnelConductor(Float cosThetaI, Float eta, Float k) {
    Float c = std::clamp(cosThetaI, Float(1e-6), Float(1));
    Float s2 = 1 - c * c;
    Float re = (eta * eta - k * k - 1) + c * c, im = 2 * eta * k;
    Float modulus = std::sqrt(re * re + im * im);
    Float a = std::sqrt(std::max(Float(0), (modulus + re) / 2));  // a + i b = sqrt(index^2 - sin^2)
    Float b2 = std::max(Float(0), (modulus - re) / 2);
    Float perpendicular = (Sqr(a - c) + b2) / (Sqr(a + c) + b2);
    Float ratio = (Sqr(a * c - s2) + b2 * c * c) / (Sqr(a * c + s2) + b2 * c * c);
    return perpendicular * (1 + ratio) / 2;
}

inline SampledSpectrum FresnelConductor(Float cosThetaI, const SampledSpectrum &eta, const SampledSpectrum &k) {
    return SampledSpectrum::Of([&](int i) { return FresnelConductor(cosThetaI, eta[i], k[i]); });
}

inline Vector3 Reflect(const Vector3 &w, const Vector3 &n) { return n * (2 * Dot(w, n)) - w; }

/// Refracts `w` at a boundary with normal n and relative index `eta` (as in FresnelDielectric, with n for z). False
/// under total internal reflection. `etaRelative` (may be null) gets the index on the far side over that on w's side.
inline bool Refract(const Vector3 &w, Normal3 n, Float eta, Float *etaRelative, Vector3 *wt) {
    Float cosI = Dot(n, w);
    if (cosI < 0) {
        eta = 1 / eta;
        cosI = -cosI;
        n = -n;
    }
    Float sin2T = std::max(Float(0), 1 - cosI * cosI) / (eta * eta);
    if (sin2T >= 1) return false;
    *wt = n * (cosI / eta - std::sqrt(1 - sin2T)) - w / eta;
    if (etaRelative) *etaRelative = eta;
    return true;
}

}  // namespace pbrt
