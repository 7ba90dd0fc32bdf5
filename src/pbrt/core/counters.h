#pragma once
#include <cstdint>

namespace pbrt {

/// Counts of what one thread did. Each thread adds to its own copy; SumCounters adds up the copies of all threads.
struct RenderCounters {
    uint64_t closestHitRays = 0;
    uint64_t shadowRays = 0;
    uint64_t shadowRaysBlocked = 0;
    uint64_t pathVertices = 0;
    uint64_t cameraPaths = 0;
    uint64_t zeroLightSamples = 0;  ///< light sampling returned nothing to trace
    uint64_t mediumLookups = 0;     ///< places at which a medium's coefficients were asked for

    void operator+=(const RenderCounters &o) {
        closestHitRays += o.closestHitRays;
        shadowRays += o.shadowRays;
        shadowRaysBlocked += o.shadowRaysBlocked;
        pathVertices += o.pathVertices;
        cameraPaths += o.cameraPaths;
        zeroLightSamples += o.zeroLightSamples;
        mediumLookups += o.mediumLookups;
    }
};

/// The calling thread's counters.
RenderCounters &ThreadCounters();
/// Sum over all threads since the last reset. This and ResetCounters may be called only while no parallel work runs.
RenderCounters SumCounters();
void ResetCounters();
/// Adds what was counted elsewhere.
void AddCounters(const RenderCounters &counters);

}  // namespace pbrt
