#include "pbrt/core/counters.h"

#include <memory>
#include <mutex>
#include <vector>

namespace pbrt {
namespace {
struct Registry {
    std::mutex mutex;
    std::vector<std::unique_ptr<RenderCounters>> all;
};
Registry &Counters() {
    static Registry registry;
    return registry;
}
RenderCounters *Register() {
    Registry &r = Counters();
    std::lock_guard lock(r.mutex);
    r.all.push_back(std::make_unique<RenderCounters>());
    return r.all.back().get();
}
}  // namespace

RenderCounters &ThreadCounters() {
    thread_local RenderCounters *mine = Register();
    return *mine;
}

RenderCounters SumCounters() {
    Registry &r = Counters();
    std::lock_guard lock(r.mutex);
    RenderCounters sum;
    for (const auto &c : r.all) sum += *c;
    return sum;
}

void ResetCounters() {
    Registry &r = Counters();
    std::lock_guard lock(r.mutex);
    for (auto &c : r.all) *c = RenderCounters{};
}

}  // namespace pbrt
