#pragma once
#include <mutex>
#include <optional>
#include <thread>

#include "pbrt/core/progress.h"
#include "pbrt/core/team.h"

namespace pbrt {

/// Distributes the numbers [0, count) to the threads of all ranks on demand, each once. Rank 0 holds the counter and a
/// thread that serves requests; ranks prefetch a few numbers at a time. Collective: all ranks create one, take until it
/// is empty, and call Finish; no other messages are sent meanwhile. Cancelling `progress` on one rank stops
/// distribution and cancels it on all.
class WorkDistributor {
  public:
    /// `threads`: of this process.
    WorkDistributor(Team &team, int64_t count, int threads, Progress &progress);
    ~WorkDistributor();

    /// Thread-safe. Empty: no numbers are left.
    std::optional<int64_t> Take();
    /// Adds to the amount done; thread-safe. On rank 0 `progress` advances by the amounts of all ranks.
    void Report(int64_t amount);
    /// Called after the last Take; on rank 0, waits until all others have been served. Returns the reported amount that
    /// did not reach rank 0.
    int64_t Finish();

  private:
    struct Numbers {
        int64_t begin = 0, end = 0;
    };
    void Reply();
    void SendRequest();
    Numbers TakeFromCounter(int64_t most);

    Team &team_;
    Progress &progress_;
    const int threads_;
    std::mutex mutex_;  ///< protects the members below; on ranks above 0 also MPI
    Numbers left_;      ///< rank 0: not yet distributed; others: received, not yet taken
    bool isWaiting_ = false, isOver_ = false;
    int64_t done_ = 0;  ///< not reported yet
    std::thread replies_;
};

/// Calls work(i) for i in [0, count) on the threads of all ranks, in any order, until `progress` is cancelled; it
/// advances by the results of `work`. Returns the amount that did not reach rank 0.
int64_t DistributeWork(Team &team, int64_t count, Progress &progress, const std::function<int64_t(int64_t)> &work);

}  // namespace pbrt
