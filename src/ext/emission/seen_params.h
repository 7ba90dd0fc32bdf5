#pragma once
#include "pbrt/core/describe.h"

namespace ext {
using namespace pbrt;

/// Parameters of the light sampler "seen".
struct SeenParams {
    Float floor = 0.25f;
    Float budget = 0.01f;
    bool meshlights = true;

    template <class V>
    void Describe(V &&v) {
        v("floor", floor, Range<Float>{0.01f, 1.f}, "share of choices that are made by power alone");
        v("budget", budget, Range<Float>{1e-4f, 1.f},
          "paths of the prepass as a share of the render's; 8,192 at least, about a million at most");
        v("meshlights", meshlights,
          "an emissive mesh is one light; inside it a triangle is chosen by its share of the power");
    }
};

}  // namespace ext
