#include "pbrt/core/counters.h"

#include <oneapi/tbb/enumerable_thread_specific.h>

namespace pbrt {
namespace {

tbb::enumerable_thread_specific<RenderCounters> allCounters;

}  // namespace

RenderCounters &ThreadCounters() {
    thread_local RenderCounters &mine = allCounters.local();
    return mine;
}

RenderCounters SumCounters() {
    RenderCounters sum;
    for (const RenderCounters &c : allCounters) sum += c;
    return sum;
}

void ResetCounters() {
    for (RenderCounters &c : allCounters) c = {};
}

}  // namespace pbrt
