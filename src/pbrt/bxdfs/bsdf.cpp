#include "pbrt/bxdfs/bsdf.h"

#include <type_traits>

#include "pbrt/math/low_discrepancy.h"

namespace pbrt {
namespace {

/// Calls f with the active lobe; returns a default-constructed result if there is none. (A chain of comparisons: unlike
/// std::visit it neither throws nor uses a jump table.)
template <size_t I = 1, class Variant, class Function>
auto Dispatch(Variant &lobes, Function f) {
    using Result = decltype(f(*std::get_if<1>(&lobes)));
    if constexpr (I < std::variant_size_v<std::remove_const_t<Variant>>) {
        if (auto *lobe = std::get_if<I>(&lobes)) return f(*lobe);
        return Dispatch<I + 1>(lobes, f);
    } else {
        return Result();
    }
}

auto ApproximationOf(const auto &lobe, const Vector3 &wo) {
    if constexpr (requires { lobe.ApproximationTerms(wo); }) {
        return [&lobe, wo, terms = lobe.ApproximationTerms(wo)](const Vector3 &wi) {
            return lobe.Approximate(wo, wi, terms);
        };
    } else {
        return [&lobe, wo](const Vector3 &wi) -> Float {
            if constexpr (requires { lobe.Approximate(wo, wi); }) return lobe.Approximate(wo, wi);
            else return lobe.F(wo, wi, TransportMode::Radiance).Average();
        };
    }
}

}  // namespace

bool Bsdf::IsDirectional() const {
    return Dispatch(lobe_, [](const auto &lobe) {
        if constexpr (requires { lobe.IsDirectional(); }) return lobe.IsDirectional();
        else return Has(lobe.Flags(), BxdfFlags::Glossy);
    });
}

bool Bsdf::HasExactF() const {
    return Dispatch(lobe_, [](const auto &lobe) {
        if constexpr (requires { lobe.UsesTable(); }) return lobe.UsesTable();
        else return true;
    });
}

void Bsdf::ApproximateF(const Vector3 &wo, std::span<const Vector3> wi, Float *f) const {
    const Vector3 o = frame_.ToLocal(wo);
    Dispatch(lobe_, [&](const auto &lobe) {
        const auto approximation = ApproximationOf(lobe, o);
        for (size_t k = 0; k < wi.size(); ++k) {
            const Vector3 i = frame_.ToLocal(wi[k]);
            f[k] = o.z == 0 || i.z == 0 ? 0 : approximation(i);
        }
        return true;
    });
}

SampledSpectrum Bsdf::F(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const {
    Vector3 o = frame_.ToLocal(wo);
    if (o.z == 0) return SampledSpectrum(0);
    Vector3 i = frame_.ToLocal(wi);
    return Dispatch(lobe_, [&](const auto &lobe) { return lobe.F(o, i, mode); });
}

SampledSpectrum Bsdf::FOfSamples(const Vector3 &wo, const Vector3 &wi) const {
    const Vector3 o = frame_.ToLocal(wo);
    if (o.z == 0) return SampledSpectrum(0);
    const Vector3 i = frame_.ToLocal(wi);
    return Dispatch(lobe_, [&](const auto &lobe) {
        if constexpr (requires { lobe.FConsistent(o, i, TransportMode::Radiance); })
            return lobe.FConsistent(o, i, TransportMode::Radiance);
        else return lobe.F(o, i, TransportMode::Radiance);
    });
}

std::optional<BsdfSample> Bsdf::Sample(const Vector3 &wo, Float uc, const Point2 &u, TransportMode mode) const {
    Vector3 o = frame_.ToLocal(wo);
    if (o.z == 0 || flags_ == BxdfFlags::None) return {};
    auto sample = Dispatch(lobe_, [&](const auto &lobe) { return lobe.Sample(o, uc, u, mode); });
    if (!sample) return sample;
    if (!(sample->pdf > 0) || sample->wi.z == 0 || !sample->f) return {};
    sample->wi = frame_.FromLocal(sample->wi);
    return sample;
}

Float Bsdf::Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const {
    Vector3 o = frame_.ToLocal(wo);
    if (o.z == 0 || flags_ == BxdfFlags::None) return 0;
    Vector3 i = frame_.ToLocal(wi);
    return Dispatch(lobe_, [&](const auto &lobe) { return lobe.Pdf(o, i, mode); });
}

void Bsdf::UseWalks() {
    Dispatch(lobe_, [](auto &lobe) {
        if constexpr (requires { lobe.UseWalks(); }) lobe.UseWalks();
        return true;
    });
}

void Bsdf::Regularize() {
    flags_ = Dispatch(lobe_, [](auto &lobe) {
        if constexpr (requires { lobe.Regularize(); }) lobe.Regularize();
        return lobe.Flags();
    });
}

SampledSpectrum EstimateAlbedo(const Bsdf &given, const Vector3 &wo) {
    // With so few samples the result depends on the sampling, which must match stock's.
    Bsdf bsdf = given;
    bsdf.UseWalks();
    constexpr int kPoints = 16;
    // The position of lobe numbers in their strata decides whether a faint coat is sampled at all. As in stock pbrt-v4
    // the smallest is 0.0473, above the reflectance of glass; it is paired with u.x = 1/32, where rough facets are hit
    // near normal incidence.
    constexpr Float kOffset = Float(0.757);
    SampledSpectrum sum(0);
    for (int i = 0; i < kPoints; ++i) {
        const auto index = uint64_t(kPoints - i);
        const Point2 u(RadicalInverse(2, index), RadicalInverse(3, index));
        const Float uLobe = (Float(i) + kOffset) / kPoints;
        if (auto s = bsdf.Sample(wo, uLobe, u); s && s->pdf > 0)
            sum += s->f * (AbsDot(s->wi, bsdf.ShadingFrame().z) / s->pdf);
    }
    return sum / kPoints;
}

}  // namespace pbrt
