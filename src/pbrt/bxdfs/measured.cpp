#include "pbrt/bxdfs/measured.h"

#include "pbrt/bxdfs/fresnel.h"
#include "pbrt/math/catmull_rom.h"
#include "pbrt/math/frame.h"
#include "pbrt/math/warps.h"

namespace pbrt {
namespace {

struct Cell {
    int index;
    Float t;
};

/// Cell that contains x, for n knots over [0, 1]; the first cell if x is NaN.
Cell CellOf(Float x, int n) {
    Float at = (x > 0 ? std::min(x, Float(1)) : Float(0)) * Float(n - 1);
    int i = std::min(int(at), n - 2);
    return {i, at - Float(i)};
}

/// Integral from 0 to t of a linear density from a at 0 to b at 1, and its inverse.
Float MassBelow(Float t, Float a, Float b) { return t * (a + (b - a) * t / 2); }

Float WhereMassIs(Float mass, Float a, Float b) {
    Float total = (a + b) / 2;
    return total > 0 ? SampleLinear(std::clamp(mass / total, Float(0), OneMinusEpsilon), a, b) : 0;
}

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

Float GridSlices::Evaluate(const Point2 &p, size_t slice) const {
    const Cell x = CellOf(p.x, nx_), y = CellOf(p.y, ny_);
    return Lerp(y.t, Lerp(x.t, At(slice, x.index, y.index), At(slice, x.index + 1, y.index)),
                Lerp(x.t, At(slice, x.index, y.index + 1), At(slice, x.index + 1, y.index + 1)));
}

BilinearWarp::BilinearWarp(const GridSlices &values) : nx_(values.Nx()), ny_(values.Ny()) {
    const size_t perSlice = nx_ * ny_;
    density_.resize(values.Count() * perSlice);
    left_.resize(density_.size());
    below_.resize(values.Count() * ny_);
    std::vector<double> left(perSlice), below(ny_);
    for (size_t s = 0; s < values.Count(); ++s) {
        for (int y = 0; y < ny_; ++y) {
            for (int x = 0; x < nx_; ++x)
                left[Index(x, y)] =
                    x == 0 ? 0
                           : left[Index(x - 1, y)] + (double(values.At(s, x - 1, y)) + double(values.At(s, x, y))) / 2;
            below[y] = y == 0 ? 0 : below[y - 1] + (left[Index(nx_ - 1, y - 1)] + left[Index(nx_ - 1, y)]) / 2;
        }
        const double total = below.back();
        for (int y = 0; y < ny_; ++y) {
            for (int x = 0; x < nx_; ++x) {
                density_[s * perSlice + Index(x, y)] = Float(double(values.At(s, x, y)) / total);
                left_[s * perSlice + Index(x, y)] = Float(left[Index(x, y)] / total);
            }
            below_[s * ny_ + y] = Float(below[y] / total);
        }
    }
}

BilinearWarp::Mapped BilinearWarp::Sample(const Point2 &u, const SliceBlend &blend) const {
    const int y = FindPiece(
        ny_, [&](int i) { return MassBelowRow(blend, i); }, u.y);
    const Float row0 = Left(blend, nx_ - 1, y), row1 = Left(blend, nx_ - 1, y + 1);
    const Float ty = WhereMassIs(u.y - MassBelowRow(blend, y), row0, row1);

    auto left = [&](int i) { return Lerp(ty, Left(blend, i, y), Left(blend, i, y + 1)); };
    const Float mass = u.x * Lerp(ty, row0, row1);
    const int x = FindPiece(nx_, left, mass);
    const Float d0 = Lerp(ty, Density(blend, x, y), Density(blend, x, y + 1));
    const Float d1 = Lerp(ty, Density(blend, x + 1, y), Density(blend, x + 1, y + 1));
    const Float tx = WhereMassIs(mass - left(x), d0, d1);
    return {{(Float(x) + tx) / Float(nx_ - 1), (Float(y) + ty) / Float(ny_ - 1)}, Lerp(tx, d0, d1) / CellArea()};
}

BilinearWarp::Mapped BilinearWarp::Invert(const Point2 &p, const SliceBlend &blend) const {
    const Cell x = CellOf(p.x, nx_), y = CellOf(p.y, ny_);
    const Float row0 = Left(blend, nx_ - 1, y.index), row1 = Left(blend, nx_ - 1, y.index + 1);
    const Float d0 = Lerp(y.t, Density(blend, x.index, y.index), Density(blend, x.index, y.index + 1));
    const Float d1 = Lerp(y.t, Density(blend, x.index + 1, y.index), Density(blend, x.index + 1, y.index + 1));
    const Float row = Lerp(y.t, row0, row1);
    const Float left =
        Lerp(y.t, Left(blend, x.index, y.index), Left(blend, x.index, y.index + 1)) + MassBelow(x.t, d0, d1);
    return {{row > 0 ? std::clamp(left / row, Float(0), Float(1)) : 0,
             std::clamp(MassBelowRow(blend, y.index) + MassBelow(y.t, row0, row1), Float(0), Float(1))},
            Lerp(x.t, d0, d1) / CellArea()};
}

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
