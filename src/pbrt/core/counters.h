#pragma once
#include <cstdint>

namespace pbrt {

/// Per-thread statistics. SumCounters adds the copies of all threads.
struct RenderCounters {
    uint64_t closestHitRays = 0, shadowRays = 0, shadowRaysBlocked = 0, pathVertices = 0, cameraPaths = 0;
    uint64_t mediumLookups = 0;  ///< evaluations of a medium's coefficients

    void operator+=(const RenderCounters &o) {
        closestHitRays += o.closestHitRays;
        shadowRays += o.shadowRays;
        shadowRaysBlocked += o.shadowRaysBlocked;
        pathVertices += o.pathVertices;
        cameraPaths += o.cameraPaths;
        mediumLookups += o.mediumLookups;
    }
};

RenderCounters &ThreadCounters();
/// Sum over all threads since the last reset. This and ResetCounters must not run concurrently with parallel work.
RenderCounters SumCounters();
void ResetCounters();

}  // namespace pbrt
