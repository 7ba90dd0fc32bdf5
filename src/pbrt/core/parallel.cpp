#include "pbrt/core/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#ifdef PBRT_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace pbrt {

struct ThreadLimit::Impl {
    tbb::global_control control;
    tbb::task_arena arena;
};

namespace {
tbb::task_arena *currentArena = nullptr;  // set only by ThreadLimit, outside of parallel work

void InArena(auto &&f) {
    if (currentArena) currentArena->execute(f);
    else f();
}

#ifdef PBRT_THREAD_SANITIZER
/// Declares the task order of a parallel region to ThreadSanitizer, which cannot detect oneTBB's synchronisation: each
/// task runs between begin and end of the region.
class RegionOrder {
  public:
    RegionOrder() { __tsan_release(&begin_); }
    ~RegionOrder() { __tsan_acquire(&end_); }
    void Run(auto &&task) {
        __tsan_acquire(&begin_);
        task();
        __tsan_release(&end_);
    }

  private:
    char begin_ = 0, end_ = 0;
};
#else
struct RegionOrder {
    void Run(auto &&task) { task(); }
};
#endif
}  // namespace

ThreadLimit::ThreadLimit(int n) {
    int threads = n > 0 ? n : tbb::info::default_concurrency();
    // The aggregate's members cannot be moved.
    impl_.reset(
        new Impl{tbb::global_control(tbb::global_control::max_allowed_parallelism, threads), tbb::task_arena(threads)});
    currentArena = &impl_->arena;
}

ThreadLimit::~ThreadLimit() { currentArena = nullptr; }

int ThreadCount() { return currentArena ? currentArena->max_concurrency() : tbb::this_task_arena::max_concurrency(); }

int ThreadIndex() { return std::max(0, tbb::this_task_arena::current_thread_index()); }

void ParallelFor(int64_t count, int64_t grain, const std::function<void(int64_t, int64_t)> &body) {
    RegionOrder order;
    InArena([&] {
        tbb::parallel_for(tbb::blocked_range<int64_t>(0, count, grain),
                          [&](const tbb::blocked_range<int64_t> &r) { order.Run([&] { body(r.begin(), r.end()); }); });
    });
}

void ParallelForEach(int64_t count, const std::function<void(int64_t)> &body) {
    RegionOrder order;
    InArena([&] {
        tbb::parallel_for(
            tbb::blocked_range<int64_t>(0, count, 1),
            [&](const tbb::blocked_range<int64_t> &r) {
                for (int64_t i = r.begin(); i < r.end(); ++i) order.Run([&] { body(i); });
            },
            tbb::simple_partitioner());
    });
}

void ParallelInvoke(const std::function<void()> &a, const std::function<void()> &b) {
    RegionOrder order;
    InArena([&] { tbb::parallel_invoke([&] { order.Run(a); }, [&] { order.Run(b); }); });
}

}  // namespace pbrt
