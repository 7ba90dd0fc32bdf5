#pragma once
#include "pbrt/core/describe.h"

namespace ext {
using namespace pbrt;

struct OracleParams {
    int samples = 32;
    Float floor = 0.02f;
    bool mis = true;
    bool meshlights = true;
    bool interior = true;

    template <class V>
    void Describe(V &&v) {
        v("samples", samples, Range<int>{1, 4096}, "shadow rays to every light, each time a light is chosen");
        v("floor", floor, Range<Float>{1e-4f, 1.f},
          "share of the probability handed out by unoccluded importance, whatever the shadow rays saw");
        v("mis", mis, "least variance of light and BSDF sampling combined; false: of light sampling alone");
        v("meshlights", meshlights,
          "an emissive mesh is one light for selection; false: every primitive is a light, with shadow rays of its "
          "own");
        v("interior", interior,
          "primitives of a mesh are chosen by importance at the point, as the octree does; false: by power");
    }
};

}  // namespace ext
