#pragma once
#include <atomic>
#include <mutex>
#include <optional>
#include <thread>

#include "pbrt/core/progress.h"
#include "pbrt/core/team.h"

namespace pbrt {

/// Distributes the numbers [0, count) to the threads of all processes on request, each number once. Rank 0 has the
/// counter, and a thread that replies to the others; they request a few numbers at a time, and the next ones before
/// these are used up. All processes make such an object, take until nothing is left, and call Finish; meanwhile no
/// other messages are sent. If `progress` is cancelled in one process, no more numbers are distributed, and it becomes
/// cancelled in all.
class WorkDistributor {
  public:
    /// `threads`: of this process.
    WorkDistributor(Team &team, int64_t count, int threads, Progress &progress);
    ~WorkDistributor();

    /// From any thread. Empty: nothing is left.
    std::optional<int64_t> Take();
    /// Adds to the amount that is done; from any thread. On rank 0 `progress` advances by the amounts of all processes.
    void Report(int64_t amount);
    /// After the last Take: returns, on rank 0, when all others have the reply that nothing is left. Returns the
    /// reported amount that did not reach rank 0.
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
    std::mutex mutex_;  ///< for what follows; on ranks above 0 for MPI, too
    Numbers left_;      ///< rank 0: not distributed yet; others: received and not taken yet
    bool isWaiting_ = false, isOver_ = false;
    int64_t done_ = 0;  ///< not reported yet
    std::thread replies_;
};

/// Calls work(i) for every i of [0, count) on the threads of all processes of the team, in any order, until `progress`
/// is cancelled; it advances by what `work` returns. Returns the amount that did not reach the progress of rank 0.
int64_t DistributeWork(Team &team, int64_t count, Progress &progress, const std::function<int64_t(int64_t)> &work);

}  // namespace pbrt
