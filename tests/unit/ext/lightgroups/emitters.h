#pragma once
#include <gtest/gtest.h>

#include <vector>

#include "ext/lightgroups/emitter.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "support/light_query.h"

namespace pbrt::test {

using namespace ext;

inline Emitter Patch(const Point3 &p, const Vector3 &normal, Float intensity) {
    const LightBounds b{.bounds = Bounds3(p, p + Vector3(0.01f)), .w = normal, .phi = double(intensity)};
    return {.bounds = b, .isArea = true, .intensity = intensity};
}

/// Sizes of a test's set of emitters.
struct PatchCounts {
    int count, far;
};
inline std::string NameOf(const testing::TestParamInfo<PatchCounts> &p) {
    return std::to_string(p.param.count) + "And" + std::to_string(p.param.far) + "Far";
}

/// `count` flat patches at random places in a cube, with `far` infinite lights among them.
inline std::vector<Emitter> Patches(int count, int far) {
    Rng rng(count);
    std::vector<Emitter> emitters;
    for (int i = 0; i < std::max(count, far); ++i) {
        const Point3 p(rng.Uniform(), rng.Uniform(), rng.Uniform());
        const Vector3 normal = SampleUniformSphere(rng.Uniform2());
        if (i < count) emitters.push_back(Patch(p, normal, rng.Uniform() + 0.1f));
        if (i >= far) continue;
        emitters.push_back({.bounds = {}, .isFar = true, .m0 = 1, .m1 = {0, 0, 0.5f}});
    }
    return emitters;
}

inline LightQuery QueryIn(Rng &rng) {
    const Point3 p(rng.Uniform(), rng.Uniform(), rng.Uniform());
    return QueryAt(p, SampleUniformSphere(rng.Uniform2()));
}

/// The importance G of one emitter.
inline Float GOf(const Emitter &e, const LightQuery &query) {
    if (e.isFar) return EvaluateFar(e, query);
    EmitterPacket alone;
    Float g[EmitterPacket::kLanes];
    alone.Set(0, e);
    alone.Evaluate(query, g);
    return g[0];
}

}  // namespace pbrt::test
