#pragma once
#include <array>
#include <span>
#include <vector>

#include "ext/groups/mesh_groups.h"
#include "pbrt/lightsamplers/light_packet.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {

/// G: an estimate of the light that arrives at a point from each of many emitters if nothing is in the way, in the units
/// of irradiance. For an emitter in a sphere (centre c, radius r, at distance d, s = r / d the sine of its half angle):
///
///   G = I C(axis, -w) C(n, w) / max(d^2, r^2),   w towards c
///
/// I is the power divided by the solid angle it leaves into (pi for flat emitters, 4 pi for points and closed ones). C is
/// the mean clamped cosine over the sphere's extent: cos where the sphere is wholly above the horizon, 0 where wholly
/// below, (cos + s)^2 / (4 s) between: unlike a bound it stays an estimate near the horizon, and it is 0 exactly where no
/// point of the sphere can contribute. The receiver's side is the one it is seen from, both sides if the BSDF transmits,
/// all directions in a medium. Inside the sphere both cosines count as 1/2.
/// Lights at infinity: the mean and the first moment of their radiance give E(n) = M0/4 + M1.n/2, at least M0/40; a
/// single direction gives the clamped cosine. Lights that are never sampled (uniform skies are left to BSDF sampling) have
/// G = 0.
/// Positive wherever SampleLi can give a contribution (tests/unit/ext/groups); the same bits wherever it is called.
class GroupImportance {
  public:
    /// What one emitter looks like; emitters of a group become one, as MeshGroups makes them.
    GroupImportance(const LightTable &lights, const MeshGroups &groups);
    /// The primitives of one group, by their order in it.
    GroupImportance(const LightTable &lights, const MeshGroups &groups, uint32_t group);

    size_t Size() const { return size_; }
    /// Size rounded up to whole packets: the length of Evaluate's output.
    size_t Padded() const { return packets_.size() * kLanes; }
    static constexpr int kLanes = 8;

    /// G of every emitter into out[0, Padded()); returns the sum.
    Float Evaluate(const LightQuery &query, std::span<Float> out) const;
    /// G of the named emitters, at most kMostNamed, into out[0, names.size()); returns the sum. The same numbers as
    /// Evaluate's. `names` are sorted.
    static constexpr size_t kMostNamed = 64;
    Float EvaluateSome(const LightQuery &query, std::span<const uint32_t> names, std::span<Float> out) const;
    Float Of(const LightQuery &query, uint32_t emitter) const;
    /// Unit vector to the middle of an emitter; zero for lights without one (skies).
    Vector3 DirectionTo(const Point3 &p, uint32_t emitter) const;
    size_t Bytes() const { return packets_.capacity() * sizeof(Packet) + far_.capacity() * sizeof(FarLight); }

  private:
    struct alignas(32) Packet {
        Float centerX[kLanes] = {}, centerY[kLanes] = {}, centerZ[kLanes] = {}, radius2[kLanes] = {};
        Float axisX[kLanes] = {}, axisY[kLanes] = {}, axisZ[kLanes] = {};
        Float intensity[kLanes] = {};  ///< 0: nothing here (padding, or a far light)
        Float cosO[kLanes] = {}, sinO[kLanes] = {}, cosE[kLanes] = {}, twoSided[kLanes] = {};
    };
    using Field = Float (Packet::*)[kLanes];
    static const std::array<Field, 12> kFields;
    struct FarLight {
        uint32_t emitter;
        Float m0 = 0;
        Vector3 m1{};
        bool isDelta = false;
    };
    void Add(const LightTable &lights, const LightCandidate &candidate, LightId first);
    void EvaluatePacket(const Packet &packet, const LightQuery &query, Float *out) const;
    static Float EvaluateFar(const FarLight &far, const LightQuery &query);

    std::vector<Packet> packets_;
    std::vector<FarLight> far_;
    size_t size_ = 0;
};

}  // namespace ext
