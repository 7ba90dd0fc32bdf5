#pragma once
#include "pbrt/core/describe.h"

namespace ext {
using namespace pbrt;

struct SpatialParams {
    int voxels = 64;
    int samples = 128;
    Float floor = 0.001f;
    bool meshlights = true;

    template <class V>
    void Describe(V &&v) {
        v("voxels", voxels, Range<int>{1, 256}, "voxels along the longest axis of the scene");
        v("samples", samples, Range<int>{1, 1 << 16}, "points in a voxel, each with one light sample of every light");
        v("floor", floor, Range<Float>{1e-6f, 1.f},
          "least contribution assumed of any light, as a share of the lights' mean");
        v("meshlights", meshlights, "an emissive mesh is one light for selection");
    }
};

}  // namespace ext
