#pragma once
#include "pbrt/lightsamplers/light_sampler.h"

namespace pbrt::test {

/// On a surface that is seen along its normal; by default inside a medium.
inline LightQuery QueryAt(const Point3 &p, const Normal3 &n = Normal3(0)) { return {.p = p, .wo = n, .n = n, .ns = n}; }

}  // namespace pbrt::test
