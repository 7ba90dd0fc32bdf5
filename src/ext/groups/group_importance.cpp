#include "ext/groups/group_importance.h"

namespace ext {

namespace {

/// Mean and first moment of the radiance of a light at infinity, as far as light sampling finds it: averages over its own
/// samples. For a delta light M0 is its irradiance.
void Moments(const Light &light, Float *m0, Vector3 *m1) {
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
    *m0 = static_cast<Float>(sum / (kSide * kSide));
    *m1 = first / static_cast<Float>(kSide * kSide);
}

/// The mean clamped cosine over an emitter whose directions' cosines lie between c - s and c + s (class comment).
template <class Ops, class F = typename Ops::F>
F MeanCosine(const F &c, const F &s) {
    F above = Ops::Most(c + s, F(0));
    F straddling = above * above / (F(4) * Ops::Most(s, F(1e-6f)));
    return Ops::Select(c >= s, c, straddling);
}

/// The normal of the side the receiver is seen from; zero where there is none or both sides count.
Normal3 ReceiverNormal(const LightQuery &query, bool *bothSides) {
    *bothSides = query.transmits;
    if (query.ns == Normal3(0)) return Normal3(0);
    return Dot(query.wo, query.ns) < 0 ? -query.ns : query.ns;
}

}  // namespace

constexpr std::array<GroupImportance::Field, 12> GroupImportance::kFields = {
    &Packet::centerX, &Packet::centerY, &Packet::centerZ, &Packet::radius2, &Packet::axisX, &Packet::axisY,
    &Packet::axisZ,   &Packet::intensity, &Packet::cosO,  &Packet::sinO,    &Packet::cosE,  &Packet::twoSided};

GroupImportance::GroupImportance(const LightTable &lights, const MeshGroups &groups) {
    for (uint32_t g = 0; g < groups.Size(); ++g) Add(lights, groups.Candidates()[g], LightId(groups.FirstOf(g)));
}

GroupImportance::GroupImportance(const LightTable &lights, const MeshGroups &groups, uint32_t group) {
    for (uint32_t i = groups.FirstOf(group), end = i + groups.CountOf(group); i < end; ++i)
        Add(lights, lights.Candidates()[i], LightId(i));
}

void GroupImportance::Add(const LightTable &lights, const LightCandidate &candidate, LightId first) {
    const auto emitter = static_cast<uint32_t>(size_++);
    const size_t lane = emitter % kLanes;
    if (lane == 0) packets_.emplace_back();
    const Light &light = lights[first];
    if (candidate.infinite) {
        FarLight far;
        far.emitter = emitter;
        far.isDelta = light.Kind() == LightKind::DeltaDirection;
        Moments(light, &far.m0, &far.m1);
        if (far.isDelta && far.m0 > 0) far.m1 = Normalize(far.m1);
        far_.push_back(far);
        return;
    }
    if (!candidate.bounds || !(candidate.bounds->phi > 0)) return;
    const LightSphere s = candidate.bounds->Sphere();
    Packet &p = packets_.back();
    p.centerX[lane] = s.center.x;
    p.centerY[lane] = s.center.y;
    p.centerZ[lane] = s.center.z;
    // A little larger, so that rounding cannot hide what grazes a horizon.
    p.radius2[lane] = Sqr(s.radius * 1.001f);
    p.axisX[lane] = s.w.x;
    p.axisY[lane] = s.w.y;
    p.axisZ[lane] = s.w.z;
    // Closed emitters show a quarter of their surface, flat ones all of it.
    bool isArea = light.Kind() == LightKind::Area;
    Float shown = isArea ? (1 + 3 * (1 + s.cosTheta_o) / 2) / 4 / (s.twoSided ? 2 : 1) : Float(0.25);
    p.intensity[lane] = std::clamp(s.phi * InvPi * shown, Float(1e-30f), Float(1e30f));
    p.cosO[lane] = s.cosTheta_o;
    p.sinO[lane] = SafeSqrt(1 - Sqr(s.cosTheta_o));
    p.cosE[lane] = s.cosTheta_e;
    p.twoSided[lane] = s.twoSided ? 1 : 0;
}

// Compiled once, so that all uses get the same bits.
[[gnu::noinline]] void GroupImportance::EvaluatePacket(const Packet &packet, const LightQuery &query, Float *out) const {
    using Ops = SimdOps<kLanes>;
    using F = typename Ops::F;
    auto load = [](const Float *v) { return F(v, std::experimental::element_aligned); };
    // Squared sine of a thousandth of a radian: a margin for the rounding of directions (as in LightBounds).
    constexpr Float kSlack = 1e-6f;

    F vx = load(packet.centerX) - F(query.p.x), vy = load(packet.centerY) - F(query.p.y), vz = load(packet.centerZ) - F(query.p.z);
    F d2 = Ops::Most(vx * vx + vy * vy + vz * vz, F(1e-30f)), r2 = load(packet.radius2);
    F inv = F(1) / Ops::Root(d2);
    F sin2 = Ops::Least(r2 * inv * inv + F(kSlack), F(1));
    F s = Ops::Root(sin2);
    auto inside = d2 <= r2;

    // Emission: the cosine of the angle by which the direction leaves the cone of normals.
    F cosAxis = -(load(packet.axisX) * vx + load(packet.axisY) * vy + load(packet.axisZ) * vz) * inv;
    cosAxis = Ops::Most(Ops::Least(cosAxis, F(1)), F(-1));
    cosAxis = Ops::Select(load(packet.twoSided) != F(0), Ops::Abs(cosAxis), cosAxis);
    detail::CosSin<F> beyond =
        detail::SubtractAngles<Ops>(detail::FromCosine<Ops>(cosAxis), {load(packet.cosO), load(packet.sinO)});
    // The falloff may end before or after the horizon (spot lights, wide cones): then cos is not what limits it.
    F cosE = load(packet.cosE);
    detail::CosSin<F> nearest = detail::SubtractAngles<Ops>(beyond, {Ops::Root(F(1) - sin2), s});
    F emission = Ops::Select(nearest.cos > cosE, Ops::Most(MeanCosine<Ops>(beyond.cos, s), F(1e-3f)), F(0));

    F arriving = Ops::Least(load(packet.intensity) / Ops::Most(d2, r2), F(1e36f));
    bool bothSides;
    Normal3 n = ReceiverNormal(query, &bothSides);
    F receiver(1);
    if (n != Normal3(0)) {
        F c = (F(n.x) * vx + F(n.y) * vy + F(n.z) * vz) * inv;
        if (bothSides) c = Ops::Abs(c);
        receiver = MeanCosine<Ops>(c, s);
    }
    F value = arriving * Ops::Select(inside, F(0.25f), emission * receiver);
    value.copy_to(out, std::experimental::element_aligned);
}

Float GroupImportance::EvaluateFar(const FarLight &far, const LightQuery &query) {
    bool bothSides;
    Normal3 n = ReceiverNormal(query, &bothSides);
    if (n == Normal3(0)) return far.isDelta ? far.m0 : far.m0 / 4;
    Float along = Dot(far.m1, n);
    if (bothSides) along = std::abs(along);
    if (far.isDelta) return far.m0 * std::max(along, Float(0));
    return std::max(far.m0 / 4 + along / 2, far.m0 / 40);
}

Float GroupImportance::Evaluate(const LightQuery &query, std::span<Float> out) const {
    for (size_t i = 0; i < packets_.size(); ++i) EvaluatePacket(packets_[i], query, out.data() + i * kLanes);
    for (const FarLight &far : far_) out[far.emitter] = EvaluateFar(far, query);
    Float sum = 0;
    for (size_t i = 0; i < size_; ++i) sum += out[i];
    return sum;
}

Float GroupImportance::EvaluateSome(const LightQuery &query, std::span<const uint32_t> names, std::span<Float> out) const {
    for (size_t begin = 0; begin < names.size(); begin += kLanes) {
        const size_t count = std::min<size_t>(kLanes, names.size() - begin);
        Packet gathered;
        for (size_t i = 0; i < count; ++i) {
            const Packet &from = packets_[names[begin + i] / kLanes];
            const size_t lane = names[begin + i] % kLanes;
            for (Field f : kFields) (gathered.*f)[i] = (from.*f)[lane];
        }
        Float g[kLanes];
        EvaluatePacket(gathered, query, g);
        std::copy(g, g + count, out.begin() + static_cast<std::ptrdiff_t>(begin));
    }
    for (const FarLight &far : far_) {
        auto it = std::lower_bound(names.begin(), names.end(), far.emitter);
        if (it != names.end() && *it == far.emitter) out[static_cast<size_t>(it - names.begin())] = EvaluateFar(far, query);
    }
    Float sum = 0;
    for (size_t i = 0; i < names.size(); ++i) sum += out[i];
    return sum;
}

Float GroupImportance::Of(const LightQuery &query, uint32_t emitter) const {
    for (const FarLight &far : far_)
        if (far.emitter == emitter) return EvaluateFar(far, query);
    Float out[kLanes];
    EvaluatePacket(packets_[emitter / kLanes], query, out);
    return out[emitter % kLanes];
}

Vector3 GroupImportance::DirectionTo(const Point3 &p, uint32_t emitter) const {
    for (const FarLight &far : far_)
        if (far.emitter == emitter) return far.isDelta ? far.m1 : Vector3(0);
    const Packet &packet = packets_[emitter / kLanes];
    const size_t lane = emitter % kLanes;
    Vector3 v = Point3(packet.centerX[lane], packet.centerY[lane], packet.centerZ[lane]) - p;
    Float length = Length(v);
    return length > 0 ? v / length : Vector3(0);
}

}  // namespace ext
