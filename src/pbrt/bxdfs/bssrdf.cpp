#include "pbrt/bxdfs/bssrdf.h"

#include "pbrt/bxdfs/shared_table.h"
#include "pbrt/core/parallel.h"

namespace pbrt {
namespace {

// Same knots as in stock, because interpolation between them affects images.
constexpr int kAlbedos = 100, kRadii = 64;
constexpr int kDepths = 100;

/// Mean of f over depths with density exp(-depth), at the midpoints of equiprobable intervals.
double MeanOverDepths(auto f) {
    double sum = 0;
    for (int i = 0; i < kDepths; ++i) sum += f(-std::log(1 - (i + 0.5) / kDepths));
    return sum / kDepths;
}

/// Single scattering along the beam; lengths in mean free paths. The beam contributes only below the depth from which
/// light reaches the surface at r without total reflection.
double SingleScattering(double albedo, double g, Float eta, double r) {
    const double start = r * std::sqrt(std::max(0.0, double(eta) * double(eta) - 1));
    return MeanOverDepths([&](double x) {
        const double depth = start + x;
        const double distance2 = r * r + depth * depth, distance = std::sqrt(distance2), cosine = depth / distance;
        const double s = 1 + g * g + 2 * g * cosine;  // deflection beyond 90 degrees
        const double phase = (1 - g * g) / (4 * std::numbers::pi * s * std::sqrt(s));
        const double transmitted = 1 - double(FresnelDielectric(Float(-cosine), eta));
        return albedo * std::exp(-(distance + start)) / distance2 * phase * transmitted * cosine;
    });
}

/// Multiple scattering: a dipole per depth of the beam, with Grosjean's diffusion coefficient.
struct MultipleScattering {
    double albedo, g;
    double moment1, moment2;  ///< of the inner Fresnel reflectance

    double operator()(double r) const {
        const double absorption = 1 - albedo, scattering = albedo * (1 - g);  // reduced
        const double extinction = absorption + scattering, reducedAlbedo = scattering / extinction;
        const double diffusion = (2 * absorption + scattering) / (3 * extinction * extinction);
        const double decay = std::sqrt(absorption / diffusion);
        const double mirrorHeight = -2 * diffusion * (1 + 3 * moment2) / (1 - 2 * moment1);
        const double fluenceShare = (1 - 2 * moment1) / 4, fluxShare = (1 - 3 * moment2) / 2;
        return MeanOverDepths([&](double x) {
            const double real = x / extinction, mirrored = 2 * mirrorHeight - real;
            const double toReal = std::hypot(r, real), toMirrored = std::hypot(r, mirrored);
            const double eReal = std::exp(-decay * toReal), eMirrored = std::exp(-decay * toMirrored);
            auto flux = [&](double z, double d, double e) { return z * (1 + decay * d) * e / (d * d * d); };
            const double fluence = (eReal / toReal - eMirrored / toMirrored) / diffusion;
            const double exitance = fluence * fluenceShare +
                                    (flux(real, toReal, eReal) - flux(mirrored, toMirrored, eMirrored)) * fluxShare;
            // Correction near the beam, where the dipole is too bright (Habel et al., section 5).
            const double correction = 1 - std::exp(-2 * extinction * (toReal + real));
            return correction * reducedAlbedo * reducedAlbedo * exitance / (4 * std::numbers::pi);
        });
    }
};

/// Simpson's rule over [0, 1] in two parts; `split` is the cosine where total reflection begins.
double IntegrateCosines(double split, auto f) {
    constexpr int n = 512;
    auto part = [&](double a, double b) {
        double sum = f(a) + f(b);
        for (int i = 1; i < n; ++i) sum += (i % 2 ? 4 : 2) * f(a + (b - a) * i / n);
        return sum * (b - a) / (3 * n);
    };
    return part(0, split) + part(split, 1);
}

double CriticalCosine(double etaThere) { return etaThere < 1 ? std::sqrt(1 - etaThere * etaThere) : 0; }

// Probes along the normal (third axis) find exits on flat surroundings, the others on steep ones.
constexpr Float kAxisShare[3] = {Float(0.25), Float(0.25), Float(0.5)};
constexpr Float kKeptShare = Float(0.999);

}  // namespace

Float InnerFresnelMoment(Float eta, int power) {
    return Float(IntegrateCosines(CriticalCosine(1 / double(eta)), [&](double c) {
        return double(FresnelDielectric(Float(-c), eta)) * std::pow(c, power);
    }));
}

SubsurfaceTable::SubsurfaceTable(Float eta)
    : eta_(eta), exitScale_(1 / (Pi * (1 - 2 * InnerFresnelMoment(1 / eta, 1)))), profile_(kAlbedos * kRadii),
      cdf_(kAlbedos * kRadii), reflectances_(kAlbedos) {
    radii_ = {0, Float(2.5e-3)};
    while (radii_.size() < kRadii) radii_.push_back(radii_.back() * Float(1.2));
    for (int i = 0; i < kAlbedos; ++i)
        albedos_.push_back(Float((1 - std::exp(-8.0 * i / (kAlbedos - 1))) / (1 - std::exp(-8.0))));
}

SubsurfaceTable SubsurfaceTable::Compute(Float g, Float eta) {
    SubsurfaceTable table(eta);
    const double moment1 = double(InnerFresnelMoment(eta, 1)), moment2 = double(InnerFresnelMoment(eta, 2));
    ParallelForEach(kAlbedos, [&](int64_t index) {
        const auto i = size_t(index);
        const double albedo = double(table.albedos_[i]);
        const MultipleScattering multiple{albedo, double(g), moment1, moment2};
        auto single = [&](double r) { return SingleScattering(albedo, double(g), eta, r); };
        const std::span<Float> profile = std::span(table.profile_).subspan(i * kRadii, kRadii);
        for (size_t j = 0; j < kRadii; ++j) {
            const double r = double(table.radii_[j]);
            if (r > 0) profile[j] = Float(2 * std::numbers::pi * r * (single(r) + multiple(r)));
        }
        table.reflectances_[i] =
            IntegrateCatmullRom(table.radii_, profile, std::span(table.cdf_).subspan(i * kRadii, kRadii));
    });
    return table;
}

std::shared_ptr<const SubsurfaceTable> SubsurfaceTable::Shared(Float g, Float eta) {
    return SharedTable<SubsurfaceTable>(g, eta);
}

SubsurfaceTable::Row SubsurfaceTable::AtAlbedo(Float albedo) const {
    Row row;
    row.albedo = *CatmullRomWeights(albedos_, std::clamp(albedo, Float(0), Float(1)));
    for (size_t k = 0; k < 4; ++k) row.reflectance += row.albedo.w[k] * reflectances_[row.albedo.first + k];
    return row;
}

Float SubsurfaceTable::Interpolate(const std::vector<Float> &table, const SplineWeights &albedo, int radius) const {
    const Float *at = &table[albedo.first * kRadii + radius];
    return albedo.w[0] * at[0] + albedo.w[1] * at[kRadii] + albedo.w[2] * at[2 * kRadii] + albedo.w[3] * at[3 * kRadii];
}

Float SubsurfaceTable::Profile(const Row &row, Float radius) const {
    const std::optional<SplineWeights> weights = CatmullRomWeights(radii_, radius);
    if (!weights) return 0;
    Float ring = 0;
    for (int k = 0; k < 4; ++k) ring += weights->w[k] * Interpolate(profile_, row.albedo, weights->first + k);
    return std::max(Float(0), ring / (2 * Pi * std::max(radius, Float(1e-6))));
}

Float SubsurfaceTable::SampleRadius(const Row &row, Float u) const {
    return SampleCatmullRom(
        std::span<const Float>(radii_), [&](int k) { return Interpolate(profile_, row.albedo, k); },
        [&](int k) { return Interpolate(cdf_, row.albedo, k); }, u);
}

Float SubsurfaceTable::AlbedoOf(Float reflectance) const {
    return InvertCatmullRom(albedos_, reflectances_, reflectance);
}

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
    return SampledSpectrum::Of(
        [&](int i) { return table_->Profile(rows_[i], distance * sigmaT_[i]) * Sqr(sigmaT_[i]); });
}

}  // namespace pbrt
