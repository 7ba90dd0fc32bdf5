#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/light_sampler.h"

namespace ext {
using namespace pbrt;

/// Parameters of G, the unoccluded contribution estimate, of one or several lights. Powers are relative to
/// LightTable::Unit().
struct Emitter {
    std::optional<LightBounds> bounds;  ///< of the portal, if any; empty: at infinity, or dark
    bool isArea = false;
    Float intensity = 0;  ///< radiance times area (flat emitter) or intensity (point light)

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
/// An EmitterRow stores the parameters of one emitter in one cache line; an EmitterPacket those of eight as structure
/// of arrays.
struct alignas(64) EmitterRow {
    /// Indices in `field`; the first kPacketFields belong to packets as well.
    static constexpr size_t kCenterX = 0, kCenterY = 1, kCenterZ = 2, kRadius2 = 3, kAxisX = 4, kAxisY = 5, kAxisZ = 6;
    static constexpr size_t kIntensity = 7;  ///< 0: no emitter
    static constexpr size_t kInside = 8;     ///< G within the sphere
    static constexpr size_t kSide = 9;       ///< 1: one-sided, -1: two-sided
    static constexpr size_t kCosO = 10, kSinO = 11, kCosE = 12, kPacketFields = 13;
    static constexpr size_t kIsCurved = 13;  ///< 1: normals vary (kCosO is not 1)
    static constexpr size_t kIsCut = 14;     ///< 1: emission does not end at the horizon (kCosE is not 0)
    Float field[16] = {};

    EmitterRow() = default;
    explicit EmitterRow(const Emitter &emitter);
};

struct alignas(32) EmitterPacket {
    static constexpr int kLanes = 8;
    Float field[EmitterRow::kPacketFields][kLanes] = {};
    /// In some lane kIsCurved, kIsCut. If both are false, kCosO, kSinO and kCosE are not read.
    bool someCurved = false, someCut = false;

    /// Sets an empty lane.
    void Set(size_t lane, const Emitter &emitter);
    Point3 Center(size_t lane) const {
        return {field[EmitterRow::kCenterX][lane], field[EmitterRow::kCenterY][lane],
                field[EmitterRow::kCenterZ][lane]};
    }
    /// Writes G of the eight lanes. A lane's result is bit-identical for all call sites and contents of other lanes.
    void Evaluate(const LightQuery &query, Float *out) const { EvaluateAll(this, 1, query, out); }
    /// Writes G of all lanes of `count` consecutive packets and returns the sum.
    static Float EvaluateAll(const EmitterPacket *packets, size_t count, const LightQuery &query, Float *out);
    static Float Sum(const Float *g);  ///< sum of the output of Evaluate; `g` is aligned like packets
};
/// Fills `packet` with `count` <= 8 rows; clears the other lanes.
void Gather(const EmitterRow *rows, const uint32_t *names, size_t count, EmitterPacket *packet);

Float EvaluateFar(const Emitter &far, const LightQuery &query);  ///< G of an emitter at infinity
struct FarEmitter {
    uint32_t index;  ///< in the list of emitters
    Emitter emitter;
};

/// Evaluates G (see EmitterPacket) of a list of emitters.
class GroupImportance {
  public:
    explicit GroupImportance(std::span<const Emitter> emitters);
    explicit GroupImportance(const LightGroups &groups) : GroupImportance(EmittersOf(groups)) {}

    static std::vector<Emitter> EmittersOf(const LightGroups &groups);

    size_t Size() const { return size_; }
    /// Size rounded up to whole packets: output length of Evaluate.
    size_t Padded() const { return packets_.size() * kLanes; }
    static constexpr int kLanes = EmitterPacket::kLanes;

    /// Writes G of every emitter to out[0, Padded()) and returns the sum.
    Float Evaluate(const LightQuery &query, std::span<Float> out) const;
    Float Of(const LightQuery &query, uint32_t emitter) const;
    /// Unit vector to the centre of an emitter; zero for environment lights.
    Vector3 DirectionTo(const Point3 &p, uint32_t emitter) const;
    size_t Bytes() const { return packets_.capacity() * sizeof(EmitterPacket) + far_.capacity() * sizeof(FarEmitter); }

  private:
    const FarEmitter *FindFar(uint32_t emitter) const;

    std::vector<EmitterPacket> packets_;
    std::vector<FarEmitter> far_;
    size_t size_ = 0;
};

/// Position and direction of an emitter as one vector, for clustering. Positions are relative to the bounds' diagonal:
/// its ends are 1 apart, opposite directions of flat emitters 0.7.
using EmitterFeature = std::array<Float, 6>;

struct EmitterItem {
    uint32_t emitter = 0;
    Float weight = 0;
    EmitterFeature feature{};
};

/// Minimum emitters of a node whose children are built in parallel; LightTree splits such nodes at the median.
inline constexpr size_t kManyEmitters = 4096;

/// Sets the features of all items, relative to the bounds of their positions.
inline void FindFeatures(std::span<EmitterItem> items, std::span<const Emitter> emitters) {
    Bounds3 cloud;
    for (const EmitterItem &item : items) cloud = Union(cloud, emitters[item.emitter].bounds->Centroid());
    const Point3 center = items.empty() ? Point3(0) : cloud.Center();
    const Float size = items.empty() ? Float(1) : Length(cloud.Diagonal());
    const Float invSize = size > 0 ? 1 / size : 1;
    for (EmitterItem &item : items) {
        const Emitter &e = emitters[item.emitter];
        const Vector3 place = (e.bounds->Centroid() - center) * invSize;
        const Float direction = e.isArea && !e.bounds->twoSided ? Float(0.35) * (1 + e.bounds->cosTheta_o) / 2 : 0;
        const Vector3 w = e.bounds->w * direction;
        item.feature = {place.x, place.y, place.z, w.x, w.y, w.z};
    }
}

/// Feature axis of maximum spread over a list of items.
struct WidestAxis {
    double spread = 0;  ///< weighted sum of squared distances from the mean
    size_t axis = 0;

    explicit WidestAxis(std::span<const EmitterItem> items) {
        double mean[6] = {}, square[6] = {}, weight = 0;
        for (const EmitterItem &item : items) {
            auto w = double(item.weight);
            weight += w;
            for (size_t a = 0; a < 6; ++a) {
                mean[a] += w * double(item.feature[a]);
                square[a] += w * double(item.feature[a] * item.feature[a]);
            }
        }
        for (size_t a = 0; a < 6; ++a) {
            double v = weight > 0 ? square[a] - mean[a] * mean[a] / weight : 0;
            if (v > spread) {
                spread = v;
                axis = a;
            }
        }
    }
};

/// Orders by one feature coordinate, ties by index, so that the result is independent of the input order.
struct LessAlong {
    size_t axis = 0;
    bool operator()(const EmitterItem &a, const EmitterItem &b) const {
        return a.feature[axis] != b.feature[axis] ? a.feature[axis] < b.feature[axis] : a.emitter < b.emitter;
    }
};

}  // namespace ext
