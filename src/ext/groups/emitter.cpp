#include "ext/groups/emitter.h"

namespace ext {

namespace {

/// Moments of a light at infinity, as averages over its own samples.
void FindMoments(const Light &light, Emitter *e) {
    constexpr int kSide = 32;
    const SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    LightSampleContext from{};
    double sum = 0;
    Vector3 first(0);
    for (int i = 0; i < kSide * kSide; ++i) {
        Point2 u((static_cast<Float>(i % kSide) + 0.5f) / kSide, (static_cast<Float>(i / kSide) + 0.5f) / kSide);
        std::optional<LightLiSample> s = light.SampleLi(from, u, lambda, true);
        if (!s || !(s->pdf > 0)) continue;
        Float value = SafeDivide(s->L, lambda.Pdf()).Average() / s->pdf;
        if (!(value > 0) || !std::isfinite(value)) continue;
        sum += static_cast<double>(value);
        first += value * s->wi;
    }
    e->m0 = static_cast<Float>(sum / (kSide * kSide));
    e->m1 = first / static_cast<Float>(kSide * kSide);
    if (e->isDelta && e->m0 > 0) e->m1 = Normalize(e->m1);
}

/// The mean clamped cosine over an emitter whose directions' cosines lie between c - s and c + s (see G).
template <class Ops, class F = typename Ops::F>
F MeanCosine(const F &c, const F &s) {
    F above = Ops::Most(c + s, F(0));
    F straddling = above * above / (F(4) * Ops::Most(s, F(1e-6f)));
    return Ops::Select(c >= s, c, straddling);
}

/// The normal of the side the receiver is seen from; zero in a medium.
Normal3 ReceiverNormal(const LightQuery &query) {
    if (query.ns == Normal3(0)) return Normal3(0);
    return Dot(query.wo, query.ns) < 0 ? -query.ns : query.ns;
}

using Field = Float (EmitterPacket::*)[EmitterPacket::kLanes];
constexpr std::array<Field, 12> kFields = {
    &EmitterPacket::centerX, &EmitterPacket::centerY,   &EmitterPacket::centerZ, &EmitterPacket::radius2,
    &EmitterPacket::axisX,   &EmitterPacket::axisY,     &EmitterPacket::axisZ,   &EmitterPacket::intensity,
    &EmitterPacket::cosO,    &EmitterPacket::sinO,      &EmitterPacket::cosE,    &EmitterPacket::twoSided};

}  // namespace

Emitter MakeEmitter(const Light &first, const LightCandidate &candidate) {
    Emitter e;
    if (candidate.infinite) {
        e.isFar = true;
        e.isDelta = first.Kind() == LightKind::DeltaDirection;
        FindMoments(first, &e);
        return e;
    }
    if (!candidate.bounds || !(candidate.bounds->phi > 0)) return e;
    e.bounds = candidate.bounds;
    e.isArea = first.Kind() == LightKind::Area;
    if (e.isArea) {
        e.intensity = candidate.power * InvPi / (candidate.bounds->twoSided ? 2 : 1);
    } else {
        // Full strength within theta_o, half of it on average in the falloff.
        Float inner = SafeACos(candidate.bounds->cosTheta_o), outer = std::min(inner + SafeACos(candidate.bounds->cosTheta_e), Pi);
        Float solidAngle = Pi * ((1 - std::cos(inner)) + (1 - std::cos(outer)));
        e.intensity = candidate.power / std::max(solidAngle, Float(1e-4));
    }
    return e;
}

Emitter Union(const Emitter &a, const Emitter &b) {
    if (!a.bounds) return b;
    if (!b.bounds) return a;
    Emitter e;
    e.bounds = Union(*a.bounds, *b.bounds);
    e.isArea = a.isArea || b.isArea;
    e.intensity = a.intensity + b.intensity;
    return e;
}

void EmitterPacket::Set(size_t lane, const Emitter &e) {
    if (!e.bounds) return;
    const LightSphere s = e.bounds->Sphere();
    centerX[lane] = s.center.x;
    centerY[lane] = s.center.y;
    centerZ[lane] = s.center.z;
    // A little larger, so that rounding cannot hide what grazes a horizon.
    radius2[lane] = Sqr(s.radius * 1.001f);
    axisX[lane] = s.w.x;
    axisY[lane] = s.w.y;
    axisZ[lane] = s.w.z;
    Float shown = e.isArea ? (1 + 3 * (1 + s.cosTheta_o) / 2) / 4 : Float(1);
    intensity[lane] = std::clamp(e.intensity * shown, Float(1e-30f), Float(1e30f));
    cosO[lane] = s.cosTheta_o;
    sinO[lane] = SafeSqrt(1 - Sqr(s.cosTheta_o));
    cosE[lane] = s.cosTheta_e;
    twoSided[lane] = s.twoSided ? 1 : 0;
}

void EmitterPacket::CopyLane(size_t lane, const EmitterPacket &from, size_t fromLane) {
    for (Field f : kFields) (this->*f)[lane] = (from.*f)[fromLane];
}

// Compiled once, so that all uses get the same bits.
[[gnu::noinline]] void EmitterPacket::Evaluate(const LightQuery &query, Float *out) const {
    using Ops = SimdOps<kLanes>;
    using F = typename Ops::F;
    auto load = [](const Float *v) { return F(v, std::experimental::element_aligned); };
    // Squared sine of a thousandth of a radian: a margin for the rounding of directions (as in LightBounds).
    constexpr Float kSlack = 1e-6f;

    F vx = load(centerX) - F(query.p.x), vy = load(centerY) - F(query.p.y), vz = load(centerZ) - F(query.p.z);
    F d2 = Ops::Most(vx * vx + vy * vy + vz * vz, F(1e-30f)), r2 = load(radius2);
    F inv = F(1) / Ops::Root(d2);
    F sin2 = Ops::Least(r2 * inv * inv + F(kSlack), F(1));
    F s = Ops::Root(sin2);

    // Emission: the cosine of the angle by which the direction leaves the cone of normals. The falloff may end before or
    // after the horizon (spot lights, wide cones): then that cosine is not what limits it.
    F cosAxis = -(load(axisX) * vx + load(axisY) * vy + load(axisZ) * vz) * inv;
    cosAxis = Ops::Most(Ops::Least(cosAxis, F(1)), F(-1));
    cosAxis = Ops::Select(load(twoSided) != F(0), Ops::Abs(cosAxis), cosAxis);
    detail::CosSin<F> beyond = detail::SubtractAngles<Ops>(detail::FromCosine<Ops>(cosAxis), {load(cosO), load(sinO)});
    detail::CosSin<F> nearest = detail::SubtractAngles<Ops>(beyond, {Ops::Root(F(1) - sin2), s});
    F emission = Ops::Select(nearest.cos > load(cosE), Ops::Most(MeanCosine<Ops>(beyond.cos, s), F(1e-3f)), F(0));

    F arriving = Ops::Least(load(intensity) / Ops::Most(d2, r2), F(1e36f));
    Normal3 n = ReceiverNormal(query);
    F receiver(1);
    if (n != Normal3(0)) {
        F c = (F(n.x) * vx + F(n.y) * vy + F(n.z) * vz) * inv;
        if (query.transmits) c = Ops::Abs(c);
        receiver = MeanCosine<Ops>(c, s);
    }
    F value = arriving * Ops::Select(d2 <= r2, F(0.25f), emission * receiver);
    value.copy_to(out, std::experimental::element_aligned);
}

Float EvaluateFar(const Emitter &far, const LightQuery &query) {
    Normal3 n = ReceiverNormal(query);
    if (n == Normal3(0)) return far.isDelta ? far.m0 : far.m0 / 4;
    Float along = Dot(far.m1, n);
    if (query.transmits) along = std::abs(along);
    if (far.isDelta) return far.m0 * std::max(along, Float(0));
    return std::max(far.m0 / 4 + along / 2, far.m0 / 40);
}

}  // namespace ext
