#pragma once
#include "pbrt/core/describe.h"

namespace ext {
using namespace pbrt;

struct NeeppParams {
    int voxels = 16;
    int samples = 16;
    Float floor = 0.02f;
    bool meshlights = true;

    template <class V>
    void Describe(V &&v) {
        v("voxels", voxels, Range<int>{1, 128}, "voxels along the longest axis of the scene");
        v("samples", samples, Range<int>{1, 255}, "segments tested for a pair of voxels");
        v("floor", floor, Range<Float>{1e-4f, 1.f}, "least visibility assumed of any light");
        v("meshlights", meshlights, "an emissive mesh is one light for selection");
    }
};

}  // namespace ext
