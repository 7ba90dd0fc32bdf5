#pragma once
#include "pbrt/core/describe.h"

namespace ext {
using namespace pbrt;

/// Parameters of the visibility map, which are the first parameters of the light sampler and of the shadow-ray gate.
struct VisibilityMapParams {
    int voxels = 16;
    int samples = 16;

    template <class V>
    void Describe(V &&v) {
        v("voxels", voxels, Range<int>{1, 128}, "voxels along the longest axis of the scene");
        v("samples", samples, Range<int>{1, 255}, "segments tested for a pair of voxels");
    }
};

struct NeeppParams {
    VisibilityMapParams map;
    Float floor = 0.02f;
    bool meshlights = true;

    template <class V>
    void Describe(V &&v) {
        map.Describe(v);
        v("floor", floor, Range<Float>{1e-4f, 1.f}, "least visibility assumed of any light");
        v("meshlights", meshlights, "an emissive mesh is one light for selection");
    }
};

struct NeeppGateParams {
    VisibilityMapParams map;
    Float minimum = 0.1f;

    template <class V>
    void Describe(V &&v) {
        map.Describe(v);
        v("minimum", minimum, Range<Float>{1e-3f, 1.f}, "least probability of tracing a shadow ray");
    }
};

}  // namespace ext
