#include "pbrt/bxdfs/measured.h"

#include "pbrt/bxdfs/fresnel.h"
#include "pbrt/math/frame.h"

namespace pbrt {
namespace {

struct Knot {
    size_t index, next;
    Float t;
};

/// Interval of increasing numbers that contains x, clamped to their range.
Knot Locate(const std::vector<Float> &axis, Float x) {
    if (axis.size() < 2 || !(x > axis.front())) return {0, 0, 0};
    if (x >= axis.back()) return {axis.size() - 1, axis.size() - 1, 0};
    size_t i = size_t(std::upper_bound(axis.begin(), axis.end(), x) - axis.begin()) - 1;
    return {i, i + 1, (x - axis[i]) / (axis[i + 1] - axis[i])};
}

Float Theta(const Vector3 &w) { return 2 * std::asin(std::min(Length(w - Vector3(0, 0, 1)) / 2, Float(1))); }
Float Phi(const Vector3 &w) { return std::atan2(w.y, w.x); }
Float SquareOfTheta(Float theta) { return std::sqrt(theta * (2 / Pi)); }
Float SquareOfPhi(Float phi) { return phi * Inv2Pi + Float(0.5); }

/// Half-vector solid angle per unit-square area.
Float SolidAngleByArea(Float x, Float sinTheta) { return std::max(2 * Sqr(Pi) * x * sinTheta, Float(1e-6)); }

}  // namespace

struct MeasuredBrdf::View {
    Float phi;
    Point2 square;
    SliceBlend blend;
    Vector3 wo;
};

MeasuredBrdf::View MeasuredBrdf::ViewFrom(const Vector3 &wo) const {
    const Float theta = Theta(wo), phi = Phi(wo);
    const Knot p = Locate(t_.phi, phi), t = Locate(t_.theta, theta);
    const size_t n = t_.theta.size();
    return {phi,
            {SquareOfTheta(theta), SquareOfPhi(phi)},
            {{p.index * n + t.index, p.index * n + t.next, p.next * n + t.index, p.next * n + t.next},
             {(1 - p.t) * (1 - t.t), (1 - p.t) * t.t, p.t * (1 - t.t), p.t * t.t}},
            wo};
}

Point2 MeasuredBrdf::SquareOfHalf(const View &view, const Vector3 &half) const {
    const Float y = SquareOfPhi(isotropic_ ? Phi(half) - view.phi : Phi(half));
    return {SquareOfTheta(Theta(half)), y - std::floor(y)};
}

SampledSpectrum MeasuredBrdf::Value(const View &view, const Point2 &measured, const Point2 &half, Float cosI,
                                    const SampledWavelengths &lambda) const {
    SampledSpectrum value;
    for (int i = 0; i < SpectrumSamples; ++i) {
        const Knot w = Locate(t_.wavelengths, lambda[i]);
        Float sum = 0;
        for (size_t k = 0; k < 4; ++k) {
            if (view.blend.weight[k] == 0) continue;
            const size_t first = view.blend.slice[k] * t_.wavelengths.size();
            sum += view.blend.weight[k] * Lerp(w.t, t_.spectra.Evaluate(measured, first + w.index),
                                               t_.spectra.Evaluate(measured, first + w.next));
        }
        value[i] = std::max(sum, Float(0));
    }
    return value * (t_.ndf.Evaluate(half, 0) / (4 * t_.sigma.Evaluate(view.square, 0) * cosI));
}

SampledSpectrum MeasuredBrdf::F(const Vector3 &wo, const Vector3 &wi, const SampledWavelengths &lambda) const {
    const View view = ViewFrom(wo);
    const Point2 half = SquareOfHalf(view, Normalize(wo + wi));
    return Value(view, t_.visibleNormals.Invert(half, view.blend).p, half, wi.z, lambda);
}

Float MeasuredBrdf::Pdf(const Vector3 &wo, const Vector3 &wi) const {
    const View view = ViewFrom(wo);
    const Vector3 halfVector = Normalize(wo + wi);
    const Point2 half = SquareOfHalf(view, halfVector);
    const BilinearWarp::Mapped measured = t_.visibleNormals.Invert(half, view.blend);
    return measured.pdf * t_.luminance.Invert(measured.p, view.blend).pdf /
           (4 * Dot(wo, halfVector) * SolidAngleByArea(half.x, SinTheta(halfVector)));
}

std::optional<BsdfSample> MeasuredBrdf::Sample(const Vector3 &wo, const Point2 &u,
                                               const SampledWavelengths &lambda) const {
    const View view = ViewFrom(wo);
    // The square's y grows with phi, its x with theta.
    const BilinearWarp::Mapped measured = t_.luminance.Sample(u, view.blend);
    const BilinearWarp::Mapped half = t_.visibleNormals.Sample(measured.p, view.blend);
    const Float theta = Sqr(half.p.x) * (Pi / 2), phi = (2 * half.p.y - 1) * Pi + (isotropic_ ? view.phi : 0);
    const Float sinTheta = std::sin(theta);
    const Vector3 halfVector = SphericalDirection(sinTheta, std::cos(theta), phi);
    const Vector3 wi = Reflect(wo, halfVector);
    const Float cosHalf = Dot(wo, halfVector);
    if (!(wi.z > 0) || !(cosHalf > 0)) return {};
    return BsdfSample{Value(view, measured.p, half.p, wi.z, lambda), wi,
                      measured.pdf * half.pdf / (4 * cosHalf * SolidAngleByArea(half.p.x, sinTheta)),
                      BxdfFlags::Glossy | BxdfFlags::Reflection};
}

SampledSpectrum MeasuredBxdf::F(const Vector3 &wo, const Vector3 &wi, TransportMode) const {
    if (!SameHemisphere(wo, wi)) return SampledSpectrum(0);
    return wo.z < 0 ? Brdf().F(-wo, -wi, lambda_) : Brdf().F(wo, wi, lambda_);
}

std::optional<BsdfSample> MeasuredBxdf::Sample(const Vector3 &wo, Float, const Point2 &u, TransportMode) const {
    const Float side = wo.z < 0 ? Float(-1) : Float(1);
    auto sample = Brdf().Sample(wo * side, u, lambda_);
    if (sample) sample->wi *= side;
    return sample;
}

Float MeasuredBxdf::Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode) const {
    if (!SameHemisphere(wo, wi)) return 0;
    return wo.z < 0 ? Brdf().Pdf(-wo, -wi) : Brdf().Pdf(wo, wi);
}

}  // namespace pbrt
