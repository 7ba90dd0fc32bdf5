#include "ext/lightgroups/mesh_interior.h"

#include "pbrt/core/parallel.h"

namespace ext {

MeshInterior::MeshInterior(const LightGroups &groups, bool byImportance)
    : groups_(groups), byImportance_(byImportance), inner_(groups.Size()) {
    if (!byImportance) return;
    ParallelForEach(groups.Size(), 4, [&](int64_t index) {
        const auto g = uint32_t(index);
        const uint32_t count = groups.CountOf(g);
        if (count == 1) return;
        std::vector<Emitter> emitters;
        for (uint32_t i = groups.FirstOf(g), last = i + count; i < last; ++i)
            emitters.push_back(MakeEmitter(groups.Lights(), LightId(i), groups.Lights().Candidate(LightId(i))));
        if (count <= kMaxScan) inner_[g].scan = std::make_unique<GroupImportance>(emitters);
        else inner_[g].tree = std::make_unique<EmitterTree>(emitters);
    });
}

std::optional<SampledLight> MeshInterior::Sample(uint32_t group, const LightQuery &query, Float u) const {
    const uint32_t first = groups_.FirstOf(group);
    if (!byImportance_) {
        LightId light = groups_.SampleLight(group, u);
        return SampledLight{light, groups_.ShareOf(light)};
    }
    const Inner &inner = inner_[group];
    if (inner.tree) {
        std::optional<SampledLight> chosen = inner.tree->Sample(query, u);
        if (chosen) chosen->light = LightId(first + chosen->light.value);
        return chosen;
    }
    if (!inner.scan) return SampledLight{LightId(first), 1};
    Float g[kMaxScan];
    Float sum = inner.scan->Evaluate(query, g);
    if (!(sum > 0)) return {};
    const auto chosen = ChooseByWeight<Float>(inner.scan->Size(), u * sum, [&](uint32_t i) { return g[i]; });
    if (!chosen) return {};
    return SampledLight{LightId(first + chosen.index), chosen.weight / sum};
}

Float MeshInterior::PMF(const LightQuery &query, LightId light) const {
    if (!byImportance_) return groups_.ShareOf(light);
    const uint32_t group = groups_.GroupOf(light);
    const Inner &inner = inner_[group];
    const uint32_t index = light.value - groups_.FirstOf(group);
    if (inner.tree) return inner.tree->PMF(query, index);
    if (!inner.scan) return 1;
    Float g[kMaxScan];
    Float sum = inner.scan->Evaluate(query, g);
    return sum > 0 ? g[index] / sum : 0;
}

size_t MeshInterior::Bytes() const {
    size_t bytes = inner_.capacity() * sizeof(Inner);
    for (const Inner &i : inner_) bytes += (i.scan ? i.scan->Bytes() : 0) + (i.tree ? i.tree->Bytes() : 0);
    return bytes;
}

}  // namespace ext
