#pragma once
#include <span>
#include <vector>

#include "ext/lightgroups/emitter.h"
#include "pbrt/lights/light_table.h"

namespace ext {

/// Evaluates G (see EmitterPacket) of a list of emitters.
class GroupImportance {
  public:
    explicit GroupImportance(std::span<const Emitter> emitters);
    explicit GroupImportance(const LightGroups &groups) : GroupImportance(EmittersOf(groups)) {}

    static std::vector<Emitter> EmittersOf(const LightGroups &groups);
    static std::vector<Emitter> EmittersIn(const LightGroups &groups, uint32_t group);

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

}  // namespace ext
