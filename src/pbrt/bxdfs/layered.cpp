#include "pbrt/bxdfs/layered.h"

#include "pbrt/bxdfs/henyey_greenstein.h"
#include "pbrt/math/rng.h"

namespace pbrt {
namespace {

// Inside, directions are those of travel: w.z < 0 goes down to the base at z = 0, w.z > 0 up to the coat at z =
// thickness. Lobes expect directions away from the boundary, hence the signs in their calls.

/// Separate random streams keep the estimates of f and of the density that weights it independent.
enum class Stream : uint64_t { Evaluate = 1, Density = 2, Draw = 3 };

constexpr int kRouletteDepth = 3;
constexpr Float kRouletteThreshold = Float(0.25);
/// Fraction of the estimated density in Pdf; the rest is uniform over the sphere.
constexpr Float kDensityTrust = Float(0.9);
/// Geometric series up to this many base hits are summed term by term.
constexpr int kSummedHits = 16;

/// Russian roulette at low throughput.
bool EndsByRoulette(SampledSpectrum &beta, Rng &rng) {
    const Float continuation = beta.MaxComponent();
    return continuation < kRouletteThreshold && pbrt::EndsByRoulette(continuation, rng, beta);
}

TransportMode Reverse(TransportMode mode) {
    return mode == TransportMode::Radiance ? TransportMode::Importance : TransportMode::Radiance;
}

bool Usable(const std::optional<BsdfSample> &s) { return s && s->pdf > 0 && s->wi.z != 0 && s->f; }

/// Height of the next collision from z along w (extinction 1).
Float SampleCollision(Float z, const Vector3 &w, Float u) { return z - w.z * std::log(1 - u); }

/// Random numbers seeded by six values. The seed's factors are multiplied in parallel, because a chain of hashes would
/// dominate short walks.
Rng NumbersFor(Stream stream, const Vector3 &a, const Vector3 &b) {
    const auto words = std::bit_cast<std::array<uint64_t, 3>>(std::array<Float, 6>{a.x, a.y, a.z, b.x, b.y, b.z});
    return Rng(MixBits(words[0] * 0x9e3779b97f4a7c15ull ^ std::rotl(words[1] * 0xc2b2ae3d27d4eb4full, 23) ^
                       std::rotl(words[2] * 0x165667b19e3779f9ull, 41) ^ (uint64_t(stream) << 32)));
}

std::optional<BsdfSample> Draw(const auto &lobe, const Vector3 &wo, Rng &rng, TransportMode mode) {
    Float uc = rng.Uniform();
    Point2 u = rng.Uniform2();
    return lobe.Sample(wo, uc, u, mode);
}

}  // namespace

template <class Base>
BxdfFlags CoatedBxdf<Base>::Flags() const {
    BxdfFlags top = top_.Flags(), bottom = bottom_.Flags(), flags = BxdfFlags::Reflection;
    if (IsSpecular(top)) flags = flags | BxdfFlags::Specular;
    if (scatters_ || Has(bottom, BxdfFlags::Diffuse)) return flags | BxdfFlags::Diffuse;
    return Has(top | bottom, BxdfFlags::Glossy) ? flags | BxdfFlags::Glossy : flags;
}

template <class Base>
SampledSpectrum CoatedBxdf<Base>::F(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const {
    return Evaluate<ExitWeights::Stock>(wo, wi, mode);
}

template <class Base>
SampledSpectrum CoatedBxdf<Base>::FConsistent(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const {
    return Evaluate<ExitWeights::Consistent>(wo, wi, mode);
}

template <class Base>
typename CoatedBxdf<Base>::Passage CoatedBxdf<Base>::Through(const Vector3 &w) const {
    Passage passage;
    if (Refract(w, Normal3(0, 0, 1), top_.Eta(), nullptr, &passage.inside))
        passage.transmitted = (1 - FresnelDielectric(w.z, top_.Eta())) * Transmittance(thickness_, passage.inside);
    return passage;
}

template <class Base>
Float CoatedBxdf<Base>::Approximate(const Vector3 &wo, const Vector3 &wi, const Passage &in) const {
    if (!SameHemisphere(wo, wi)) return 0;
    const Float side = wo.z < 0 ? Float(-1) : Float(1);
    const Vector3 i = wi * side;
    const Float mirrored = top_.F(wo * side, i, TransportMode::Radiance)[0];
    const Passage out = Through(i);
    const Float transmitted = in.transmitted * out.transmitted / Sqr(top_.Eta());
    if (!(transmitted > 0)) return mirrored;
    return mirrored + bottom_.Approximate(-in.inside, -out.inside) * transmitted;
}

template <class Base>
template <typename CoatedBxdf<Base>::ExitWeights Weights>
SampledSpectrum CoatedBxdf<Base>::Evaluate(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const {
    if (!SameHemisphere(wo, wi)) return SampledSpectrum(0);  // the base is opaque
    Float side = wo.z < 0 ? Float(-1) : Float(1);
    Vector3 o = wo * side, i = wi * side;
    if (way_ != Way::Walk) return top_.F(o, i, mode) + ClearInside<Weights>(o, i);
    Rng rng = NumbersFor(Stream::Evaluate, o, i);
    SampledSpectrum inside(0);
    for (int s = 0; s < nSamples_; ++s) inside += EstimateInside<Weights>(o, i, mode, rng);
    return top_.F(o, i, mode) + inside / Float(nSamples_);
}

template <class Base>
typename CoatedBxdf<Base>::MirrorBounces CoatedBxdf<Base>::MirrorBouncesTo(const Vector3 &exit,
                                                                           TransportMode mode) const {
    MirrorBounces to;
    const std::optional<BsdfSample> bounce = bottom_.Sample(exit, 0, {}, mode);
    if (!bounce) return to;
    const Float transmittance = Transmittance(thickness_, exit);
    to.fromBase = bounce->f * (AbsCosTheta(exit) * transmittance / bounce->pdf);
    const Float down = std::min(top_.DrawReflection(-exit, {}).weight, OneMinusEpsilon) * transmittance;
    to.all /= SampledSpectrum(1) - to.fromBase * down;
    return to;
}

/// One walk from wo, connected to wi through the coat at every event. At rough coats the walk's next direction is also
/// evaluated at the coat, and both estimates are combined by MIS.
template <class Base>
template <typename CoatedBxdf<Base>::ExitWeights Weights>
SampledSpectrum CoatedBxdf<Base>::EstimateInside(const Vector3 &wo, const Vector3 &wi, TransportMode mode,
                                                 Rng &rng) const {
    const bool smoothTop = top_.IsSmooth(), smoothBase = IsSpecular(bottom_.Flags());
    auto draw2 = [&] { return smoothTop ? Point2() : rng.Uniform2(); };
    SampledSpectrum f(0);
    const DielectricBxdf::Drawn in = top_.DrawTransmission(wo, draw2(), mode);
    const DielectricBxdf::Drawn out = top_.DrawTransmission(wi, draw2(), Reverse(mode));
    if (!(in.weight > 0 && out.weight > 0)) return f;
    const HenyeyGreenstein phase(g_);
    const Vector3 exit = -out.wi;
    // Light scattered towards `exit` that leaves along wi, per scattered light.
    const Float exitWeight = out.weight / AbsCosTheta(exit), exitTransmittance = Transmittance(thickness_, exit);
    const MirrorBounces mirrored = smoothTop && smoothBase ? MirrorBouncesTo(exit, mode) : MirrorBounces();
    // Adds light leaving through the coat along w, sampled with density `pdf`. `alternative`: the connection could also
    // have sampled it.
    auto leave = [&](const SampledSpectrum &beta, const Vector3 &w, Float dz, Float pdf, bool alternative) {
        const DielectricBxdf::Transmission through = top_.EvaluateTransmission(-w, wi, mode);
        if (!(through.f > 0)) return;
        Float weight = 1;
        if (alternative) {
            // Density of w for entering from wi; stock uses the density of wi for leaving along w.
            Float other =
                Weights == ExitWeights::Consistent ? top_.EvaluateTransmission(wi, -w, Reverse(mode)).pdf : through.pdf;
            weight = PowerHeuristic(pdf, other);
        }
        f += beta * (through.f * weight * Transmittance(dz, w));
    };

    SampledSpectrum beta(in.weight);
    Vector3 w = in.wi;
    Float z = thickness_;
    for (int depth = 0; depth < maxDepth_; ++depth) {
        if (depth > kRouletteDepth && EndsByRoulette(beta, rng)) break;
        if (scatters_) {
            Float zCollision = SampleCollision(z, w, rng.Uniform());
            if (zCollision == z) continue;
            if (zCollision > 0 && zCollision < thickness_) {
                z = zCollision;
                Float p = phase.P(-w, exit);
                Float weight = smoothTop ? 1 : PowerHeuristic(out.pdf, p);
                SampledSpectrum up(p * weight * Transmittance(thickness_ - z, exit));
                if (mirrored.fromBase)
                    up += mirrored.fromBase * (phase.P(-w, {exit.x, exit.y, -exit.z}) * Transmittance(z, exit));
                beta *= albedo_;
                f += beta * mirrored.all * up * exitWeight;
                Vector3 scattered = phase.SampleP(-w, rng.Uniform2()).wi;
                if (scattered.z == 0) break;
                if (scattered.z > 0 && !smoothTop) leave(beta, scattered, thickness_ - z, phase.P(-w, scattered), true);
                w = scattered;
                continue;
            }
            z = std::clamp(zCollision, Float(0), thickness_);
        } else {
            z = z == 0 ? thickness_ : 0;
            beta *= Transmittance(thickness_, w);
        }

        if (z > 0) {
            const DielectricBxdf::Drawn bounce = top_.DrawReflection(-w, draw2());
            if (!(bounce.weight > 0)) break;
            beta *= bounce.weight;
            w = bounce.wi;
            continue;
        }
        if (!smoothBase) {
            Float weight = exitTransmittance * AbsCosTheta(exit);
            if (!smoothTop) weight *= PowerHeuristic(out.pdf, bottom_.Pdf(-w, exit, mode));
            f += beta * bottom_.F(-w, exit, mode) * (exitWeight * weight);
        }
        const bool isLast = depth + 2 >= maxDepth_ && !scatters_;
        if (smoothTop && isLast) break;
        auto bounce = Draw(bottom_, -w, rng, mode);
        if (!Usable(bounce)) break;
        beta *= bounce->f * (AbsCosTheta(bounce->wi) / bounce->pdf);
        w = bounce->wi;
        if (!smoothTop) leave(beta, w, thickness_, bounce->pdf, !smoothBase);
        if (isLast) break;
    }
    return f;
}

template <class Base>
std::optional<BsdfSample> CoatedBxdf<Base>::Sample(const Vector3 &wo, Float uc, const Point2 &u,
                                                   TransportMode mode) const {
    Float side = wo.z < 0 ? Float(-1) : Float(1);
    Vector3 o = wo * side;
    if (way_ != Way::Walk) {
        auto sample = SampleClear(o, uc, u);
        if (sample) sample->wi *= side;
        return sample;
    }
    auto entry = top_.Sample(o, uc, u, mode);
    if (!Usable(entry)) return {};
    if (IsReflective(entry->flags)) {
        entry->wi *= side;
        entry->pdfIsProportional = true;
        return entry;
    }

    Rng rng = NumbersFor(Stream::Draw, o, {uc, u.x, u.y});
    const HenyeyGreenstein phase(g_);
    // Light over the path's density; the returned f and pdf only have this ratio.
    SampledSpectrum beta = entry->f * (AbsCosTheta(entry->wi) / entry->pdf);
    const bool smoothTop = top_.IsSmooth();
    bool specular = smoothTop;
    Vector3 w = entry->wi;
    Float z = thickness_;
    for (int depth = 0; depth < maxDepth_; ++depth) {
        if (depth > kRouletteDepth && EndsByRoulette(beta, rng)) return {};
        if (scatters_) {
            Float zCollision = SampleCollision(z, w, rng.Uniform());
            if (zCollision == z) return {};
            if (zCollision > 0 && zCollision < thickness_) {
                beta *= albedo_;  // the phase function is sampled exactly
                specular = false;
                z = zCollision;
                w = phase.SampleP(-w, rng.Uniform2()).wi;
                if (w.z == 0) return {};
                continue;
            }
            z = std::clamp(zCollision, Float(0), thickness_);
        } else {
            z = z == 0 ? thickness_ : 0;
            beta *= Transmittance(thickness_, w);
        }
        if (z > 0) {
            const Float which1 = rng.Uniform();
            const DielectricBxdf::Drawn bounce =
                top_.DrawEither(-w, which1, smoothTop ? Point2() : rng.Uniform2(), mode);
            if (!(bounce.weight > 0)) return {};
            beta *= bounce.weight;
            w = bounce.wi;
            if (bounce.isTransmitted) {
                const BxdfFlags flags = BxdfFlags::Reflection | (specular ? BxdfFlags::Specular : BxdfFlags::Glossy);
                return BsdfSample{beta / AbsCosTheta(w), w * side, 1, flags, 1, true};
            }
            continue;
        }
        auto bounce = Draw(bottom_, -w, rng, mode);
        if (!Usable(bounce)) return {};
        beta *= bounce->f * (AbsCosTheta(bounce->wi) / bounce->pdf);
        specular = specular && IsSpecular(bounce->flags);
        w = bounce->wi;
    }
    return {};
}

template <class Base>
Float CoatedBxdf<Base>::Pdf(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const {
    Float side = wo.z < 0 ? Float(-1) : Float(1);
    const Vector3 o = wo * side, i = wi * side;
    const bool isAbove = SameHemisphere(wo, wi);
    Float pdf = 0;
    if (isAbove && way_ != Way::Walk) {
        pdf = ClearDensity(o, i, mode);
    } else if (isAbove) {
        Rng rng = NumbersFor(Stream::Density, o, i);
        for (int s = 0; s < nSamples_; ++s) pdf += EstimateDensity(o, i, mode, rng);
        pdf /= Float(nSamples_);
    }
    return way_ == Way::Smooth ? pdf : Lerp(kDensityTrust, UniformSpherePdf(), pdf);
}

/// Density of coat reflection plus the base's density for the inside directions, without refraction Jacobians; not
/// normalised, as in stock. Used for MIS weights only, which still affect images because F is biased.
template <class Base>
Float CoatedBxdf<Base>::EstimateDensity(const Vector3 &wo, const Vector3 &wi, TransportMode mode, Rng &rng) const {
    const bool smoothTop = top_.IsSmooth();
    auto draw2 = [&] { return smoothTop ? Point2() : rng.Uniform2(); };
    Float mirrored = top_.Pdf(wo, wi, mode, ReflTransFlags::Reflection);
    const DielectricBxdf::Drawn in = top_.DrawTransmission(wo, draw2(), mode);
    if (!(in.weight > 0)) return mirrored;
    const DielectricBxdf::Drawn out = top_.DrawTransmission(wi, draw2(), Reverse(mode));
    if (!(out.weight > 0)) return mirrored;
    Float base = bottom_.Pdf(-in.wi, -out.wi, mode);
    if (smoothTop) return mirrored + base;

    auto bounce = Draw(bottom_, -in.wi, rng, mode);
    if (!Usable(bounce)) return mirrored;
    Float through = top_.Pdf(-bounce->wi, wi, mode);
    if (IsSpecular(bounce->flags)) return mirrored + through;
    return mirrored + PowerHeuristic(out.pdf, base) * base + PowerHeuristic(bounce->pdf, through) * through;
}

template <class Base>
Float CoatedBxdf<Base>::ThroughSmooth(const Vector3 &w) const {
    Float cosT = 0;
    const Float reflectance = FresnelDielectric(std::min(w.z, Float(1)), top_.Eta(), &cosT);
    return reflectance < 1 ? (1 - reflectance) * std::exp(-thickness_ / cosT) : 0;
}

template <class Base>
SampledSpectrum CoatedBxdf<Base>::BaseSeries(int hits) const {
    if constexpr (std::is_same_v<Base, DiffuseBxdf>) {
        const SampledSpectrum &r = bottom_.Reflectance();
        const SampledSpectrum x = r * clear_.Inner();
        SampledSpectrum sum(hits > 0 ? 1 : 0);
        if (hits <= kSummedHits) {
            for (int k = 1; k < hits; ++k) sum = SampledSpectrum(1) + x * sum;
        } else {
            sum = x.Map([hits](Float v) { return v < 1 ? (1 - std::pow(v, Float(hits))) / (1 - v) : Float(hits); });
        }
        return r * sum;
    }
    return SampledSpectrum(0);
}

template <class Base>
template <typename CoatedBxdf<Base>::ExitWeights Weights>
SampledSpectrum CoatedBxdf<Base>::ClearInside(const Vector3 &wo, const Vector3 &wi) const {
    Float through;
    if (way_ == Way::Smooth) {
        through = ThroughSmooth(wo) * ThroughSmooth(wi);
    } else {
        const CoatShares leaving = clear_.At(wi.z);
        through = clear_.At(wo.z).through * (Weights == ExitWeights::Stock ? leaving.throughStock : leaving.through);
    }
    // The base is hit at the first event and every second one after it.
    return BaseSeries((maxDepth_ + 1) / 2) * (through * InvPi / Sqr(top_.Eta()));
}

/// Chooses between reflection by the coat and from below by their fractions. Light from below a smooth coat is nearly
/// Lambertian, because refraction preserves radiance over squared index.
template <class Base>
std::optional<BsdfSample> CoatedBxdf<Base>::SampleClear(const Vector3 &wo, Float uc, const Point2 &u) const {
    const bool smooth = way_ == Way::Smooth;
    const CoatShares shares = smooth ? CoatShares() : clear_.At(wo.z);
    const Float mirrored = smooth ? FresnelDielectric(wo.z, top_.Eta()) : shares.mirrored;
    if (uc < mirrored) {
        auto sample = top_.Sample(wo, 0, u, TransportMode::Radiance, ReflTransFlags::Reflection);
        if (!sample) return {};
        sample->pdf *= mirrored;
        sample->pdfIsProportional = true;
        return sample;
    }
    const Vector3 wi = SampleCosineHemisphere(u);
    if (wi.z == 0) return {};
    const Float through =
        (smooth ? ThroughSmooth(wo) * ThroughSmooth(wi) : shares.through * clear_.At(wi.z).through) / Sqr(top_.Eta());
    if constexpr (std::is_same_v<Base, DiffuseBxdf>) {
        // Walks leave the coat at some events only, with more weight. Russian roulette gives the sample a walk's second
        // moment, so that equally few paths continue at low throughput.
        const Float r = bottom_.Reflectance().MaxComponent(), inner = clear_.Inner();
        const Float transmission = std::min(through * (1 - inner * Sqr(r)) / Sqr(1 - inner * r), Float(1));
        if (!(uc - mirrored < transmission * (1 - mirrored))) return {};
        // Light leaves at the second event and every second one after it.
        const Float pdf = (1 - mirrored) * transmission * CosineHemispherePdf(wi.z);
        return BsdfSample{BaseSeries(maxDepth_ / 2) * (through * InvPi), wi, pdf,
                          BxdfFlags::Reflection | BxdfFlags::Glossy,     1,  true};
    }
    return {};
}

/// Under a smooth coat, the density of SampleClear without the specular reflection. Under a rough one, the density of
/// the walks as in EstimateDensity, where the entering direction matters only by whether it enters.
template <class Base>
Float CoatedBxdf<Base>::ClearDensity(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const {
    if (way_ == Way::Smooth) return (1 - FresnelDielectric(wo.z, top_.Eta())) * CosineHemispherePdf(wi.z);
    const Float mirrored = top_.Pdf(wo, wi, mode, ReflTransFlags::Reflection);
    if (bottom_.Flags() == BxdfFlags::None) return mirrored;
    const Float refracted = clear_.At(wo.z).refracted;
    Rng rng = NumbersFor(Stream::Density, wo, wi);
    Float sum = 0;
    for (int s = 0; s < nSamples_; ++s) {
        if (rng.Uniform() >= refracted) continue;
        const DielectricBxdf::Drawn out = top_.DrawTransmission(wi, rng.Uniform2(), Reverse(mode));
        if (!(out.weight > 0)) continue;
        const Float base = CosineHemispherePdf(AbsCosTheta(out.wi));
        const Vector3 up = SampleCosineHemisphere(rng.Uniform2());
        if (up.z == 0) continue;
        const Float bounced = CosineHemispherePdf(up.z);
        const Float through = top_.Pdf(-up, wi, mode);
        sum += PowerHeuristic(out.pdf, base) * base + PowerHeuristic(bounced, through) * through;
    }
    return mirrored + sum / Float(nSamples_);
}

template class CoatedBxdf<DiffuseBxdf>;
template class CoatedBxdf<ConductorBxdf>;

}  // namespace pbrt
