#pragma once
#include <atomic>
#include <mutex>
#include <optional>
#include <thread>

#include "pbrt/core/progress.h"
#include "pbrt/core/ranks.h"

namespace pbrt {

/// Hands out the numbers [0, count) to the threads of all processes, each number once, to whoever asks next. The first
/// process has the counter, and a thread that answers the others; they ask for a few numbers at a time, and for more
/// before they have used up what they got. All processes make such an object, take until there is nothing left, and
/// call Finish. Meanwhile nothing else is sent. If `progress` is cancelled on one of them, nothing more is handed out,
/// and it becomes cancelled on all.
class HandOut {
  public:
    /// `threads`: of this process.
    HandOut(Ranks &ranks, int64_t count, int threads, Progress &progress);
    ~HandOut();

    /// From any thread. Empty: all were handed out.
    std::optional<int64_t> Take();
    /// So much more is done; from any thread. On the first process `progress` advances by what all have done.
    void Report(int64_t amount);
    /// After the last Take: returns, on the first process, when the others have been told that there is no more.
    /// Returns what was reported here and did not reach the first process.
    int64_t Finish();

  private:
    struct Numbers {
        int64_t begin = 0, end = 0;
    };
    void Answer();
    void Ask();
    Numbers TakeFromCounter(int64_t most);

    Ranks &ranks_;
    Progress &progress_;
    const int threads_;
    std::mutex mutex_;  ///< for what follows; on other processes than the first for MPI, too
    Numbers left_;      ///< first process: what is not handed out; others: what was handed to this one
    bool isAsking_ = false, isOver_ = false;
    int64_t done_ = 0;  ///< not reported yet
    std::thread answers_;
};

}  // namespace pbrt
