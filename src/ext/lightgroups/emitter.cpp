#include "ext/lightgroups/emitter.h"

#include "pbrt/lights/environment_light.h"
#include "pbrt/math/lanes.h"

namespace ext {
namespace {

/// Range of strengths for which G and its sums neither overflow nor underflow.
constexpr double kMinStrength = 1e-30, kMaxStrength = 1e30;

/// Moments of a light at infinity, estimated from its own samples.
void FindMoments(const LightComponent &light, double unit, Emitter *e) {
    constexpr int kSide = 32;
    LightSampleContext from{};
    double sum = 0;
    glm::dvec3 first(0);
    for (int i = 0; i < kSide * kSide; ++i) {
        Point2 u((Float(i % kSide) + 0.5f) / kSide, (Float(i / kSide) + 0.5f) / kSide);
        std::optional<LightLiSample> s = light.SampleLi(from, u, SampledWavelengths::WholeRange(), true);
        if (!s || !(s->pdf > 0)) continue;
        const double value = RootMeanSquare(s->L) / double(s->pdf);
        if (!std::isfinite(value)) continue;
        sum += value;
        first += value * glm::dvec3(s->wi);
    }
    if (!(sum > 0)) return;
    const double m0 = std::clamp(sum / (kSide * kSide) / unit, kMinStrength, kMaxStrength);
    e->m0 = Float(m0);
    e->m1 = e->isDelta ? Normalize(Vector3(first / sum)) : Vector3(first / sum * m0);
}

using Ops = SimdOps<EmitterPacket::kLanes>;
using F = Ops::F;
using Row = EmitterRow;
F Load(const EmitterPacket &e, size_t field) { return Ops::Load(e.field[field]); }

/// Mean clamped cosine over an emitter with direction cosines in [c - s, c + s] (see G); c and s times the distance.
[[gnu::always_inline]] inline F MeanCosine(const F &c, const F &s, const F &quarterInvS) {
    F above = Ops::Max(c + s, F(0));
    return Ops::Select(c >= s, c, above * above * quarterInvS);
}

/// Squared sine of a milliradian: margin for rounding of directions (as in LightBounds).
constexpr Float kSlack = 1e-6f;
constexpr Float kMaxArriving = 1e36f;  ///< maximum intensity over squared distance; keeps sums of G finite

/// C(axis, -w) of G: the mean cosine of the angle outside the cone of normals. For emission that ends before or after
/// the horizon (spot lights), the end of the falloff replaces the horizon. `c`: cosine between direction and axis.
/// Cosines and sines are scaled by the distance d, products of two by d2.
[[gnu::always_inline]] inline F Emission(const EmitterPacket &e, const F &c, const F &d2, const F &s,
                                         const F &quarterInvS) {
    const F d = Ops::Sqrt(d2), cosO = Load(e, Row::kCosO), sinO = Load(e, Row::kSinO), cosE = Load(e, Row::kCosE);
    F sinAxis = Ops::Sqrt(Ops::Max(d2 - c * c, F(0)));
    auto within = c > cosO * d;
    F beyond = Ops::Select(cosO == F(1), c, Ops::Select(within, d, Ops::Min(c * cosO + sinAxis * sinO, d)));
    F mean = MeanCosine(beyond, s, quarterInvS);
    if (!e.someCut) return mean;
    F sinBeyond = Ops::Select(within, F(0), sinAxis * cosO - c * sinO);
    // Direction in the sphere closest to the axis: the angle minus the sphere's half angle.
    F cosExtent = Ops::Sqrt(Ops::Max(d2 - s * s, F(0)));
    auto inCone = beyond > cosExtent || beyond * cosExtent + sinBeyond * s > cosE * d2;
    F cut = Ops::Select(inCone, Ops::Max(mean, F(1e-3f) * d), F(0));
    return Ops::Select(cosE == F(0), mean, cut);
}

}  // namespace

Emitter MakeEmitter(const LightTable &lights, LightId firstId, const LightCandidate &candidate) {
    const LightComponent first = lights[firstId];
    Emitter e;
    const EnvironmentLight *environment = first.Parent().AsEnvironment();
    const std::optional<LightBounds> opening = environment ? environment->Opening() : std::nullopt;
    if (candidate.infinite && !opening) {
        e.isFar = true;
        e.isDelta = first.Kind() == LightKind::DeltaDirection;
        FindMoments(first, lights.Unit(), &e);
        return e;
    }
    // Radiance through the opening counts as emitted by it: power / pi is radiance times area.
    if (opening) return {.bounds = opening, .isArea = true, .intensity = candidate.power * InvPi};
    if (!candidate.bounds || !(candidate.bounds->phi > 0)) return e;
    e.bounds = candidate.bounds;
    e.isArea = first.Kind() == LightKind::Area;
    if (e.isArea) {
        e.intensity = candidate.power * InvPi / (candidate.bounds->twoSided ? 2 : 1);
    } else {
        // Full intensity within theta_o, half on average in the falloff.
        Float inner = SafeACos(candidate.bounds->cosTheta_o),
              outer = std::min(inner + SafeACos(candidate.bounds->cosTheta_e), Pi);
        Float solidAngle = Pi * ((1 - std::cos(inner)) + (1 - std::cos(outer)));
        e.intensity = candidate.power / std::max(solidAngle, Float(1e-4));
    }
    return e;
}

Emitter Union(const Emitter &a, const Emitter &b) {
    if (!a.bounds) return b;
    if (!b.bounds) return a;
    return {
        .bounds = Union(*a.bounds, *b.bounds), .isArea = a.isArea || b.isArea, .intensity = a.intensity + b.intensity};
}

EmitterRow::EmitterRow(const Emitter &e) {
    if (!e.bounds) return;
    const LightSphere s = e.bounds->Sphere();
    for (int i = 0; i < 3; ++i) {
        field[kCenterX + i] = s.center[i];
        field[kAxisX + i] = s.w[i];
    }
    // Slightly enlarged, so that rounding cannot hide emitters that graze a horizon.
    field[kRadius2] = Sqr(s.radius * 1.001f);
    const Float shown = e.isArea ? (1 + 3 * (1 + s.cosTheta_o) / 2) / 4 : Float(1);
    field[kIntensity] = std::clamp(e.intensity * shown, Float(kMinStrength), Float(kMaxStrength));
    field[kInside] = std::min(field[kIntensity] / std::max(field[kRadius2], Float(1e-30f)), kMaxArriving) / 4;
    field[kSide] = s.twoSided ? -1 : 1;
    // Normals that differ only by rounding count as equal (kSlack is larger).
    const bool isFlat = s.cosTheta_o > 1 - 2e-7f;
    field[kCosO] = isFlat ? 1 : s.cosTheta_o;
    field[kSinO] = isFlat ? 0 : SafeSqrt(1 - Sqr(s.cosTheta_o));
    field[kCosE] = s.cosTheta_e;
    field[kIsCurved] = isFlat ? 0 : 1;
    field[kIsCut] = s.cosTheta_e != 0 ? 1 : 0;
}

void EmitterPacket::Set(size_t lane, const Emitter &emitter) {
    const EmitterRow row(emitter);
    for (size_t f = 0; f < Row::kPacketFields; ++f) field[f][lane] = row.field[f];
    someCurved |= row.field[Row::kIsCurved] > 0;
    someCut |= row.field[Row::kIsCut] > 0;
}

// noinline: bit-identical results for all call sites. Avoids division by the distance d: with v = d w every cosine is
// scaled by d, and G = I (d C) (d C) / d^4.
[[gnu::noinline]] Float EmitterPacket::EvaluateAll(const EmitterPacket *packets, size_t count, const LightQuery &query,
                                                   Float *out) {
    const F px(query.p.x), py(query.p.y), pz(query.p.z);
    const bool inMedium = query.ns == Normal3(0);
    const Normal3 n = FaceForward(query.ns, query.wo);
    const F nx(n.x), ny(n.y), nz(n.z), otherSide(query.transmits ? Float(-1) : Float(1));
    F sum(0);
    for (size_t i = 0; i < count; ++i) {
        const EmitterPacket &e = packets[i];
        const F vx = Load(e, Row::kCenterX) - px, vy = Load(e, Row::kCenterY) - py, vz = Load(e, Row::kCenterZ) - pz;
        const F d2 = Ops::Max(vx * vx + vy * vy + vz * vz, F(1e-30f)), r2 = Load(e, Row::kRadius2);
        const F invD2 = F(1) / d2;
        const F s = Ops::Sqrt(r2 + F(kSlack) * d2), quarterInvS = F(0.25f) / s;

        F c = -(Load(e, Row::kAxisX) * vx + Load(e, Row::kAxisY) * vy + Load(e, Row::kAxisZ) * vz);
        c = Ops::Max(c, c * Load(e, Row::kSide));
        F emission = e.someCurved || e.someCut ? Emission(e, c, d2, s, quarterInvS) : MeanCosine(c, s, quarterInvS);
        F receiver;
        if (inMedium) {
            receiver = Ops::Sqrt(d2);
        } else {
            F r = nx * vx + ny * vy + nz * vz;
            receiver = MeanCosine(Ops::Max(r, r * otherSide), s, quarterInvS);
        }
        F arriving = Ops::Min(Load(e, Row::kIntensity) * invD2, F(kMaxArriving));
        F value = Ops::Select(d2 <= r2, Load(e, Row::kInside), arriving * (emission * receiver * invD2));
        Ops::Store(value, out + i * kLanes);
        sum += value;
    }
    return Ops::Sum(sum);
}

Float EmitterPacket::Sum(const Float *g) { return Ops::Sum(Ops::Load(g)); }

void Gather(const EmitterRow *rows, const uint32_t *names, size_t count, EmitterPacket *packet) {
    static const EmitterRow nothing;
    FloatLanes low[8], high[8];
    for (size_t i = 0; i < 8; ++i) {
        const EmitterRow &row = i < count ? rows[names[i]] : nothing;
        low[i] = LoadLanes<FloatLanes>(row.field);
        high[i] = LoadLanes<FloatLanes>(row.field + 8);
    }
    Transpose(low);
    Transpose(high);
    for (size_t f = 0; f < Row::kPacketFields; ++f) StoreLanes(f < 8 ? low[f] : high[f - 8], packet->field[f]);
    auto any = [](const FloatLanes &v) {
        Float most = 0;
        for (int i = 0; i < 8; ++i) most = std::max(most, v[i]);
        return most > 0;
    };
    packet->someCurved = any(high[Row::kIsCurved - 8]);
    packet->someCut = any(high[Row::kIsCut - 8]);
}

// noinline as above.
[[gnu::noinline]] Float EvaluateFar(const Emitter &far, const LightQuery &query) {
    const Normal3 n = FaceForward(query.ns, query.wo);  // 0 in media
    if (n == Normal3(0)) return far.isDelta ? far.m0 : far.m0 / 4;
    Float along = Dot(far.m1, n);
    if (query.transmits) along = std::abs(along);
    if (far.isDelta) return far.m0 * std::max(along, Float(0));
    return std::max(far.m0 / 4 + along / 2, far.m0 / 40);
}

GroupImportance::GroupImportance(std::span<const Emitter> emitters)
    : packets_((emitters.size() + kLanes - 1) / kLanes), size_(emitters.size()) {
    for (uint32_t i = 0; i < size_; ++i) {
        if (emitters[i].isFar) far_.push_back({i, emitters[i]});
        else packets_[i / kLanes].Set(i % kLanes, emitters[i]);
    }
}

std::vector<Emitter> GroupImportance::EmittersOf(const LightGroups &groups) {
    std::vector<Emitter> emitters;
    for (uint32_t g = 0; g < groups.Size(); ++g)
        emitters.push_back(MakeEmitter(groups.Lights(), LightId(groups.FirstOf(g)), groups.Candidate(g)));
    return emitters;
}

const FarEmitter *GroupImportance::FindFar(uint32_t emitter) const {
    for (const FarEmitter &far : far_)
        if (far.index == emitter) return &far;
    return nullptr;
}

Float GroupImportance::Evaluate(const LightQuery &query, std::span<Float> out) const {
    Float sum = EmitterPacket::EvaluateAll(packets_.data(), packets_.size(), query, out.data());
    for (const FarEmitter &far : far_) sum += out[far.index] = EvaluateFar(far.emitter, query);
    return sum;
}

Float GroupImportance::Of(const LightQuery &query, uint32_t emitter) const {
    if (const FarEmitter *far = FindFar(emitter)) return EvaluateFar(far->emitter, query);
    Float out[kLanes];
    packets_[emitter / kLanes].Evaluate(query, out);
    return out[emitter % kLanes];
}

Vector3 GroupImportance::DirectionTo(const Point3 &p, uint32_t emitter) const {
    if (const FarEmitter *far = FindFar(emitter)) return far->emitter.isDelta ? far->emitter.m1 : Vector3(0);
    Vector3 v = packets_[emitter / kLanes].Center(emitter % kLanes) - p;
    Float length = Length(v);
    return length > 0 ? v / length : Vector3(0);
}

}  // namespace ext
