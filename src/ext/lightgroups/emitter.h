#pragma once
#include <array>
#include <optional>

#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/light_packet.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {
using namespace pbrt;

/// What the estimate G of the unoccluded contribution needs to know of a light, or of several together. Powers are over
/// LightTable::Unit().
struct Emitter {
    std::optional<LightBounds> bounds;  ///< of the portal if there is one; empty: at infinity, or dark
    bool isArea = false;
    /// Of a flat emitter: radiance times area; of a point light: intensity.
    Float intensity = 0;

    bool isFar = false, isDelta = false;
    Float m0 = 0;   ///< far: integral of the radiance over directions (delta: irradiance), as far as SampleLi finds it
    Vector3 m1{0};  ///< far: the same times the direction (delta: the direction)
};

/// The emitter of a candidate of the table; `first` is one of the candidate's lights.
Emitter MakeEmitter(const LightTable &lights, LightId first, const LightCandidate &candidate);
/// An emitter that stands for both. Neither may be far.
Emitter Union(const Emitter &a, const Emitter &b);

/// G: an estimate of the light that arrives at a point if nothing is in the way: irradiance over LightTable::Unit().
/// For an emitter in a sphere (centre c, radius r, at distance d, s = r / d the sine of its half angle):
///
///   G = I C(axis, -w) C(n, w) / max(d^2, r^2),   w towards c
///
/// C is the mean clamped cosine over the sphere's extent: cos where the sphere is wholly above the horizon, 0 where
/// wholly below, (cos + s)^2 / (4 s) between: unlike a bound it stays an estimate near the horizon, and it is 0 exactly
/// where no point of the sphere can contribute. The receiver's side is the one it is seen from, both sides if the BSDF
/// transmits, all directions in a medium. Inside the sphere both cosines count as 1/2. Closed emitters show a quarter
/// of their surface. Far lights: the mean and the first moment of their radiance give E(n) = M0/4 + M1.n/2, at least
/// M0/40; a single direction gives the clamped cosine. A sky behind a portal is a flat emitter in its place. Lights
/// that are never sampled (uniform skies are left to BSDF sampling) have G = 0. Positive wherever SampleLi can give a
/// contribution (tests/unit/ext/lightgroups).
///
/// A packet holds eight emitters side by side.
struct alignas(32) EmitterPacket {
    static constexpr int kLanes = 8;
    Float centerX[kLanes] = {}, centerY[kLanes] = {}, centerZ[kLanes] = {}, radius2[kLanes] = {};
    Float axisX[kLanes] = {}, axisY[kLanes] = {}, axisZ[kLanes] = {};
    Float intensity[kLanes] = {};  ///< 0: nothing here
    Float inside[kLanes] = {};     ///< G within the sphere
    Float side[kLanes] = {};       ///< 1: one-sided, -1: two-sided
    Float cosO[kLanes] = {}, sinO[kLanes] = {}, cosE[kLanes] = {};
    /// `someCurved`: the normals of some lane differ (cosO is not 1). `someCut`: the emission of some lane does not end
    /// at the horizon (cosE is not 0). If both are false, cosO, sinO and cosE are not read.
    bool someCurved = false, someCut = false;

    void Set(size_t lane, const Emitter &emitter);
    Point3 Center(size_t lane) const { return {centerX[lane], centerY[lane], centerZ[lane]}; }
    /// Writes G of the eight lanes. The result of a lane is the same to the bit wherever this is called from and
    /// whatever the other lanes hold.
    void Evaluate(const LightQuery &query, Float *out) const { EvaluateAll(this, 1, query, out); }
    /// Writes G of all lanes of `count` consecutive packets and returns the sum.
    static Float EvaluateAll(const EmitterPacket *packets, size_t count, const LightQuery &query, Float *out);
    /// The sum of what Evaluate wrote, from memory aligned as packets are.
    static Float Sum(const Float *g);
};

/// One lane of a packet, in one cache line.
struct alignas(64) EmitterRow {
    Float field[16] = {};

    EmitterRow() = default;
    EmitterRow(const EmitterPacket &packet, size_t lane);
};
/// Fills `packet` with the rows of these `count` (at most eight) names; the other lanes hold nothing.
void Gather(const EmitterRow *rows, const uint32_t *names, size_t count, EmitterPacket *packet);

/// G of a far light.
Float EvaluateFar(const Emitter &far, const LightQuery &query);

}  // namespace ext
