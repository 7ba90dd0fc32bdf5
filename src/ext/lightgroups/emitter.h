#pragma once
#include <array>
#include <optional>

#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/light_packet.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {
using namespace pbrt;

/// Parameters of G, the unoccluded contribution estimate, of one or several lights. Powers are relative to
/// LightTable::Unit().
struct Emitter {
    std::optional<LightBounds> bounds;  ///< of the portal, if any; empty: at infinity, or dark
    bool isArea = false;
    /// Radiance times area (flat emitter) or intensity (point light).
    Float intensity = 0;

    bool isFar = false, isDelta = false;
    Float m0 = 0;   ///< far: integral of the radiance over directions (delta: irradiance), as covered by SampleLi
    Vector3 m1{0};  ///< far: first moment of the radiance (delta: the direction)
};

/// Emitter of a light table candidate; `first` is one of its lights.
Emitter MakeEmitter(const LightTable &lights, LightId first, const LightCandidate &candidate);
/// Emitter that represents both. Neither may be far.
Emitter Union(const Emitter &a, const Emitter &b);

/// G: estimate of the unoccluded irradiance at a point, relative to LightTable::Unit(). For an emitter in a sphere
/// (centre c, radius r, distance d, s = r / d the sine of its half angle):
///
///   G = I C(axis, -w) C(n, w) / max(d^2, r^2),   w towards c
///
/// C is the mean clamped cosine over the sphere's extent: cos where the sphere is fully above the horizon, 0 where
/// fully below, (cos + s)^2 / (4 s) between. Unlike a bound it remains an estimate near the horizon, and is 0 exactly
/// where no point of the sphere can contribute.
///
/// - Receiver: the side towards the viewer, both sides if the BSDF transmits, all directions in a medium.
/// - Inside the sphere, both cosines are 1/2. Closed emitters have a quarter of their surface area.
/// - Far lights: E(n) = M0/4 + M1.n/2, at least M0/40, from zeroth and first moment of the radiance; the clamped cosine
///   for a single direction.
/// - An environment light behind a portal is a flat emitter at the portal.
/// - Lights that are never sampled (uniform environments are left to BSDF sampling) have G = 0.
///
/// G is positive wherever SampleLi can contribute (tests/unit/ext/lightgroups).
///
/// A packet stores eight emitters as structure of arrays.
struct alignas(32) EmitterPacket {
    static constexpr int kLanes = 8;
    Float centerX[kLanes] = {}, centerY[kLanes] = {}, centerZ[kLanes] = {}, radius2[kLanes] = {};
    Float axisX[kLanes] = {}, axisY[kLanes] = {}, axisZ[kLanes] = {};
    Float intensity[kLanes] = {};  ///< 0: empty lane
    Float inside[kLanes] = {};     ///< G within the sphere
    Float side[kLanes] = {};       ///< 1: one-sided, -1: two-sided
    Float cosO[kLanes] = {}, sinO[kLanes] = {}, cosE[kLanes] = {};
    /// `someCurved`: in some lane normals vary (cosO is not 1). `someCut`: in some lane emission does not end at the
    /// horizon (cosE is not 0). If both are false, cosO, sinO and cosE are not read.
    bool someCurved = false, someCut = false;

    void Set(size_t lane, const Emitter &emitter);
    Point3 Center(size_t lane) const { return {centerX[lane], centerY[lane], centerZ[lane]}; }
    /// Writes G of the eight lanes. A lane's result is bit-identical for all call sites and contents of other lanes.
    void Evaluate(const LightQuery &query, Float *out) const { EvaluateAll(this, 1, query, out); }
    /// Writes G of all lanes of `count` consecutive packets and returns the sum.
    static Float EvaluateAll(const EmitterPacket *packets, size_t count, const LightQuery &query, Float *out);
    /// Sum of the output of Evaluate; `g` is aligned like packets.
    static Float Sum(const Float *g);
};

/// One lane of a packet, in one cache line.
struct alignas(64) EmitterRow {
    Float field[16] = {};

    EmitterRow() = default;
    EmitterRow(const EmitterPacket &packet, size_t lane);
};
/// Fills `packet` with `count` <= 8 rows; clears the other lanes.
void Gather(const EmitterRow *rows, const uint32_t *names, size_t count, EmitterPacket *packet);

Float EvaluateFar(const Emitter &far, const LightQuery &query);

}  // namespace ext
