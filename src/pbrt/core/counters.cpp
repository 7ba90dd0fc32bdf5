#include "pbrt/core/counters.h"

#include <list>
#include <mutex>

namespace pbrt {
namespace {

std::mutex countersMutex;
std::list<RenderCounters> allCounters;  ///< one per thread; their addresses do not change

RenderCounters &AddCounters() {
    const std::lock_guard lock(countersMutex);
    return allCounters.emplace_back();
}

}  // namespace

RenderCounters &ThreadCounters() {
    thread_local RenderCounters &mine = AddCounters();
    return mine;
}

RenderCounters SumCounters() {
    const std::lock_guard lock(countersMutex);
    RenderCounters sum;
    for (const RenderCounters &c : allCounters) sum += c;
    return sum;
}

void ResetCounters() {
    const std::lock_guard lock(countersMutex);
    for (RenderCounters &c : allCounters) c = {};
}

}  // namespace pbrt
