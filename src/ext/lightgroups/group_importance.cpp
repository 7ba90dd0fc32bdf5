#include "ext/lightgroups/group_importance.h"

namespace ext {

GroupImportance::GroupImportance(std::span<const Emitter> emitters)
    : packets_((emitters.size() + kLanes - 1) / kLanes), size_(emitters.size()) {
    for (uint32_t i = 0; i < size_; ++i) {
        if (emitters[i].isFar) far_.push_back({i, emitters[i]});
        else packets_[i / kLanes].Set(i % kLanes, emitters[i]);
    }
}

std::vector<Emitter> GroupImportance::EmittersOf(const LightGroups &groups) {
    std::vector<Emitter> emitters;
    emitters.reserve(groups.Size());
    for (uint32_t g = 0; g < groups.Size(); ++g)
        emitters.push_back(MakeEmitter(groups.Lights(), LightId(groups.FirstOf(g)), groups.Candidate(g)));
    return emitters;
}

std::vector<Emitter> GroupImportance::EmittersIn(const LightGroups &groups, uint32_t group) {
    const LightTable &lights = groups.Lights();
    std::vector<Emitter> emitters;
    for (uint32_t i = groups.FirstOf(group), end = i + groups.CountOf(group); i < end; ++i)
        emitters.push_back(MakeEmitter(lights, LightId(i), lights.Candidate(LightId(i))));
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
