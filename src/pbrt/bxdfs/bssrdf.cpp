#include "pbrt/bxdfs/bssrdf.h"

namespace pbrt {
namespace {

// Probes along the normal (third axis) find exits on flat surroundings, the others on steep ones.
constexpr Float kAxisShare[3] = {Float(0.25), Float(0.25), Float(0.5)};
constexpr Float kKeptShare = Float(0.999);

}  // namespace

Bssrdf::Bssrdf(const Point3 &p, const Normal3 &ns, const SampledSpectrum &sigmaA, const SampledSpectrum &sigmaS,
               const SampledWavelengths &lambda, const SubsurfaceTable &table)
    : table_(&table), p_(p), frame_(Frame::FromZ(ns)), sigmaT_(sigmaA + sigmaS),
      wavelengths_(lambda.SecondaryTerminated() ? 1 : SpectrumSamples) {
    const SampledSpectrum albedo = SafeDivide(sigmaS, sigmaT_);
    for (int i = 0; i < SpectrumSamples; ++i) {
        SubsurfaceTable::Row &row = rows_[i];
        row = table.AtAlbedo(albedo[i]);
        if (sigmaT_[i] > 0 && row.reflectance > 0) reach_[i] = table.SampleRadius(row, kKeptShare) / sigmaT_[i];
    }
}

std::optional<Bssrdf::Probe> Bssrdf::SampleProbe(Float uc, const Point2 &u) const {
    const int axis = uc < kAxisShare[0] ? 0 : uc < kAxisShare[0] + kAxisShare[1] ? 1 : 2;
    const Float begin[] = {0, kAxisShare[0], kAxisShare[0] + kAxisShare[1]};
    uc = std::clamp((uc - begin[axis]) / kAxisShare[axis], Float(0), OneMinusEpsilon);
    const int wavelength = int(uc * Float(wavelengths_));
    const Float reach = reach_[wavelength];
    if (!(reach > 0)) return {};
    const Float radius = table_->SampleRadius(rows_[wavelength], u.x) / sigmaT_[wavelength];
    if (!(radius < reach)) return {};

    const Vector3 axes[] = {frame_.x, frame_.y, frame_.z};
    const Float phi = 2 * Pi * u.y;
    const Vector3 along = axes[axis] * std::sqrt(Sqr(reach) - Sqr(radius));
    const Point3 middle =
        p_ + axes[(axis + 1) % 3] * (radius * std::cos(phi)) + axes[(axis + 2) % 3] * (radius * std::sin(phi));
    return Probe{middle + along, middle - along};
}

Float Bssrdf::Pdf(const Point3 &exit, const Normal3 &n) const {
    const Vector3 d = frame_.ToLocal(exit - p_), squared = d * d;
    const Normal3 cosines = Abs(frame_.ToLocal(n));
    const Float distance = Length(d);
    const Float radii[] = {std::sqrt(squared.y + squared.z), std::sqrt(squared.z + squared.x),
                           std::sqrt(squared.x + squared.y)};
    Float pdf = 0;
    for (int i = 0; i < wavelengths_; ++i) {
        if (!(distance < reach_[i])) continue;
        const SubsurfaceTable::Row &row = rows_[i];
        Float sum = 0;
        for (int axis = 0; axis < 3; ++axis)
            sum += kAxisShare[axis] * cosines[axis] * table_->Profile(row, radii[axis] * sigmaT_[i]);
        pdf += sum * Sqr(sigmaT_[i]) / row.reflectance;
    }
    return pdf / Float(wavelengths_);
}

SampledSpectrum Bssrdf::Profile(Float distance) const {
    SampledSpectrum s;
    for (int i = 0; i < SpectrumSamples; ++i) s[i] = table_->Profile(rows_[i], distance * sigmaT_[i]) * Sqr(sigmaT_[i]);
    return s;
}

}  // namespace pbrt
