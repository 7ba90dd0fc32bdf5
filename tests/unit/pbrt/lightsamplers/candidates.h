#pragma once
#include "pbrt/lights/light_table.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"

namespace pbrt::test {

inline LightCandidate Bounded(const LightBounds &b) { return {.power = Float(b.phi), .bounds = b}; }

inline LightCandidate InfiniteCandidate(Float power = 1) { return {.power = power, .bounds = {}, .infinite = true}; }

/// Small emitters of all kinds in the unit cube.
inline LightBounds RandomEmitter(Rng &rng) {
    LightBounds b;
    Point3 p(rng.Uniform(), rng.Uniform(), rng.Uniform());
    b.bounds = Bounds3(p, p + Vector3(rng.Uniform(), rng.Uniform(), rng.Uniform()) * Float(0.05));
    if (rng.UniformInt(3) == 0) b.bounds = Bounds3(p);
    b.w = SampleUniformSphere(rng.Uniform2());
    b.phi = double(std::exp(3 * rng.Uniform()));
    b.cosTheta_o = rng.UniformInt(4) == 0 ? Float(-1) : rng.UniformInt(2) ? Float(1) : rng.Uniform();
    b.cosTheta_e = rng.UniformInt(3) == 0 ? Float(0.9) : Float(0);
    b.twoSided = rng.UniformInt(4) == 0;
    return b;
}

inline std::vector<LightCandidate> RandomCandidates(uint64_t seed, int count) {
    Rng rng(seed);
    std::vector<LightCandidate> c;
    for (int i = 0; i < count; ++i) c.push_back(Bounded(RandomEmitter(rng)));
    return c;
}

}  // namespace pbrt::test
