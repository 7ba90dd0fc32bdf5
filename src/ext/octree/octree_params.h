#pragma once
#include "pbrt/core/describe.h"

namespace ext {
using namespace pbrt;

/// Parameters of the octree light sampler.
struct OctreeParams {
    int leaves = 4096;
    int prepassspp = 1;
    int depth = 3;
    Float floor = 0.1f;
    bool meshlights = true;

    template <class V>
    void Describe(V &&v) {
        v("leaves", leaves, Range<int>{64, 1 << 24}, "the paper's T: a cell is split while it holds more than 4N/T of the N prepass vertices");
        v("prepassspp", prepassspp, Range<int>{1, 1024}, "camera paths per pixel in the prepass");
        v("depth", depth, Range<int>{1, 64}, "vertices of a prepass path");
        v("floor", floor, Range<Float>{1e-4f, 1.f}, "share of the probability handed out by unoccluded importance, whatever the prepass saw");
        v("meshlights", meshlights, "an emissive mesh is one light for selection");
    }
};

}  // namespace ext
