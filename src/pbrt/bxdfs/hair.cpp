#include "pbrt/bxdfs/hair.h"

#include <numeric>

#include "pbrt/bxdfs/fresnel.h"
#include "pbrt/math/frame.h"

namespace pbrt {
namespace {

/// exp(-x) I0(x) for x >= 0 (Abramowitz and Stegun 9.8.1 and 9.8.2; relative error below 2e-7).
Float ScaledBesselI0(Float x) {
    if (x < 3.75f) {
        Float t = Sqr(x / 3.75f);
        Float i0 = 1 + t * (3.5156229f +
                            t * (3.0899424f + t * (1.2067492f + t * (.2659732f + t * (.0360768f + t * .0045813f)))));
        return i0 * std::exp(-x);
    }
    Float t = 3.75f / x;
    return (.39894228f +
            t * (.01328592f +
                 t * (.00225319f +
                      t * (-.00157565f +
                           t * (.00916281f +
                                t * (-.02057706f + t * (.02635537f + t * (-.01647633f + t * .00392377f)))))))) /
           std::sqrt(x);
}

Float Power(Float x, int n) {
    Float r = 1;
    for (; n; n >>= 1, x *= x)
        if (n & 1) r *= x;
    return r;
}

Float WrapAngle(Float x) {
    Float turns = std::round(x * Inv2Pi);
    return std::clamp(x - turns * (2 * Pi), -Pi, Pi);
}

Float Logistic(Float x, Float scale) {
    Float e = std::exp(-std::abs(x) / scale);
    return e / (scale * Sqr(1 + e));
}

template <class T>
T WeightedSum(const std::array<T, HairBxdf::Lobes> &weights, const std::array<Float, HairBxdf::Lobes> &values) {
    T sum(Float(0));
    for (size_t i = 0; i < weights.size(); ++i) sum += weights[i] * values[i];
    return sum;
}

std::array<Float, HairBxdf::Lobes> Averages(const std::array<SampledSpectrum, HairBxdf::Lobes> &shares) {
    std::array<Float, HairBxdf::Lobes> averages;
    for (size_t i = 0; i < averages.size(); ++i) averages[i] = shares[i].Average();
    return averages;
}

std::array<Float, HairBxdf::Lobes> Chances(const std::array<SampledSpectrum, HairBxdf::Lobes> &shares) {
    std::array<Float, HairBxdf::Lobes> chances = Averages(shares);
    const Float sum = std::accumulate(chances.begin(), chances.end(), Float(0));
    if (!(sum > 0)) return {1, 0, 0, 0};
    for (Float &c : chances) c /= sum;
    return chances;
}

}  // namespace

// With a = cosI cosO / v and b = sinI sinO / v: I0(a) exp(-b) / (2 v sinh(1/v)). Exponentials are combined so that no
// factor overflows for small v (a - b <= 1/v).
Float LongitudinalDensity(Float sinI, Float cosI, Float sinO, Float cosO, Float variance) {
    Float inverse = 1 / variance;
    Float across = cosI * cosO;
    Float exponent = (across - sinI * sinO - 1) * inverse;
    return ScaledBesselI0(across * inverse) * std::exp(std::min(exponent, Float(0))) * inverse /
           (1 - std::exp(-2 * inverse));
}

Float LogisticMass(Float scale) { return std::tanh(Pi / (2 * scale)); }
Float TrimmedLogistic(Float x, Float scale, Float mass) { return Logistic(x, scale) / mass; }
Float SampleTrimmedLogistic(Float u, Float scale, Float mass) {
    // The logistic CDF is (1 + tanh(x / (2 scale))) / 2; by symmetry no exponential overflows.
    Float t = std::clamp((2 * u - 1) * mass, -OneMinusEpsilon, OneMinusEpsilon);
    return std::clamp(2 * scale * std::atanh(t), -Pi, Pi);
}

HairBxdf::HairBxdf(Float offset, Float eta, const SampledSpectrum &sigmaA, Float betaM, Float betaN, Float alphaDegrees)
    : offset_(std::clamp(offset, Float(-1), Float(1))), eta_(eta),
      variance_(Sqr(.726f * betaM + .812f * Sqr(betaM) + 3.7f * Power(betaM, 20))),
      scale_(std::sqrt(Pi / 8) * (.265f * betaN + 1.194f * Sqr(betaN) + 5.372f * Power(betaN, 22))),
      scaleMass_(LogisticMass(scale_)), sinAlpha_(std::sin(Radians(alphaDegrees))),
      cosAlpha_(std::cos(Radians(alphaDegrees))), sigmaA_(sigmaA) {}

HairBxdf::View HairBxdf::ViewFrom(const Vector3 &wo) const {
    View view;
    const Float sinO = std::clamp(wo.x, Float(-1), Float(1)), cosO = SafeSqrt(1 - Sqr(sinO));
    view.phi = std::atan2(wo.z, wo.y);

    // Scales tilt R by -2 alpha, TT by alpha, TRT by 4 alpha (Marschner et al. 2003, halves of the elevation
    // differences).
    auto turned = [&](int lobe, Float s, Float c) {
        view.sinTheta[lobe] = sinO * c + cosO * s;
        view.cosTheta[lobe] = std::abs(cosO * c - sinO * s);
    };
    const Float sin2 = 2 * sinAlpha_ * cosAlpha_, cos2 = Sqr(cosAlpha_) - Sqr(sinAlpha_);
    turned(0, -sin2, cos2);
    turned(1, sinAlpha_, cosAlpha_);
    turned(2, 2 * sin2 * cos2, Sqr(cos2) - Sqr(sin2));
    turned(3, 0, 1);

    // Elevation refracts with eta, the azimuthal plane with Bravais' index.
    const Float cosT = SafeSqrt(1 - Sqr(sinO / eta_));
    const Float bravais = std::max(SafeSqrt(Sqr(eta_) - Sqr(sinO)) / std::max(cosO, Float(1e-6)), Float(1e-6));
    const Float sinGammaT = std::clamp(offset_ / bravais, Float(-1), Float(1)),
                cosGammaT = SafeSqrt(1 - Sqr(sinGammaT));
    const Float gammaO = std::asin(offset_), gammaT = std::asin(sinGammaT);
    for (int p = 0; p < Lobes - 1; ++p) view.turn[p] = 2 * Float(p) * gammaT - 2 * gammaO + Float(p) * Pi;

    const Float crossing = 2 * cosGammaT / std::max(cosT, Float(1e-6));  // length of one crossing, in radii
    const SampledSpectrum passed = sigmaA_.Map([&](Float s) { return std::exp(-s * crossing); });
    const Float fresnel = FresnelDielectric(cosO * SafeSqrt(1 - Sqr(offset_)), eta_);
    view.attenuation[0] = SampledSpectrum(fresnel);
    view.attenuation[1] = passed * Sqr(1 - fresnel);
    view.attenuation[2] = view.attenuation[1] * passed * fresnel;
    view.attenuation[3] = SafeDivide(view.attenuation[2] * passed * fresnel, SampledSpectrum(1) - passed * fresnel);
    return view;
}

std::array<Float, HairBxdf::Lobes> HairBxdf::Densities(const View &view, const Vector3 &wi) const {
    const Float sinI = std::clamp(wi.x, Float(-1), Float(1)), cosI = SafeSqrt(1 - Sqr(sinI));
    const Float phi = std::atan2(wi.z, wi.y) - view.phi;
    std::array<Float, Lobes> densities;
    for (int p = 0; p < Lobes; ++p) {
        const Float around =
            p < Lobes - 1 ? TrimmedLogistic(WrapAngle(phi - view.turn[p]), scale_, scaleMass_) : Inv2Pi;
        densities[p] = LongitudinalDensity(sinI, cosI, view.sinTheta[p], view.cosTheta[p], VarianceOf(p)) * around;
    }
    return densities;
}

SampledSpectrum HairBxdf::F(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const {
    if (mode == TransportMode::Importance) return F(wi, wo, TransportMode::Radiance);
    if (wi.z == 0) return SampledSpectrum(0);
    const View view = ViewFrom(wo);
    return WeightedSum(view.attenuation, Densities(view, wi)) / std::abs(wi.z);
}

HairBxdf::Terms HairBxdf::ApproximationTerms(const Vector3 &wo) const {
    const View view = ViewFrom(wo);
    return {view, Averages(view.attenuation)};
}

Float HairBxdf::Approximate(const Vector3 &, const Vector3 &wi, const Terms &terms) const {
    return WeightedSum(terms.averages, Densities(terms.view, wi)) / std::abs(wi.z);
}

Float HairBxdf::Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode) const {
    const View view = ViewFrom(wo);
    return WeightedSum(Chances(view.attenuation), Densities(view, wi));
}

std::optional<BsdfSample> HairBxdf::Sample(const Vector3 &wo, Float uc, const Point2 &u, TransportMode mode) const {
    const View view = ViewFrom(wo);
    const std::array<Float, Lobes> chances = Chances(view.attenuation);
    size_t p = 0;
    Float below = 0;
    while (p < Lobes - 1 && uc >= below + chances[p]) below += chances[p++];
    const Float within = std::clamp((uc - below) / std::max(chances[p], Float(1e-20)), Float(0), OneMinusEpsilon);

    // Elevation is sampled about the mirrored cone: an angle from the cone's direction, and a rotation about that
    // direction (d'Eon et al. 2013).
    const Float v = VarianceOf(int(p));
    const Float cosFromCone = std::clamp(1 + v * std::log(u.x + (1 - u.x) * std::exp(-2 / v)), Float(-1), Float(1));
    const Float sinI = std::clamp(
        SafeSqrt(1 - Sqr(cosFromCone)) * std::cos(2 * Pi * u.y) * view.cosTheta[p] - cosFromCone * view.sinTheta[p],
        Float(-1), Float(1));
    const Float cosI = SafeSqrt(1 - Sqr(sinI));
    const Float turn =
        p < Lobes - 1 ? view.turn[p] + SampleTrimmedLogistic(within, scale_, scaleMass_) : 2 * Pi * within;
    const Float phi = view.phi + turn;
    const Vector3 wi(sinI, cosI * std::cos(phi), cosI * std::sin(phi));
    if (wi.z == 0) return {};
    const std::array<Float, Lobes> densities = Densities(view, wi);
    const SampledSpectrum f =
        mode == TransportMode::Importance ? F(wo, wi, mode) : WeightedSum(view.attenuation, densities) / std::abs(wi.z);
    return BsdfSample{f, wi, WeightedSum(chances, densities),
                      BxdfFlags::Glossy | (SameHemisphere(wo, wi) ? BxdfFlags::Reflection : BxdfFlags::Transmission)};
}

SampledSpectrum HairBxdf::AbsorptionOfReflectance(const SampledSpectrum &c, Float betaN) {
    const Float b = betaN;
    const Float fit = 5.969f + b * (-.215f + b * (2.532f + b * (-10.73f + b * (5.574f + b * .245f))));
    return c.Map([=](Float r) { return Sqr(std::log(std::max(r, Float(1e-6))) / fit); });
}

}  // namespace pbrt
