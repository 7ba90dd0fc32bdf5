#pragma once
#include <algorithm>
#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "pbrt/core/parallel.h"
#include "pbrt/core/progress.h"
#include "pbrt/core/team.h"

namespace pbrt {

/// Distributes the numbers [0, count) to the threads of all ranks on demand, each once. Rank 0 holds the counter and a
/// thread that serves requests; ranks prefetch a few numbers at a time. Collective: all ranks create one, take until it
/// is empty, and call Finish; no other messages are sent meanwhile. Cancelling `progress` on one rank stops
/// distribution and cancels it on all.
class WorkDistributor {
  public:
    WorkDistributor(Team &team, int64_t count, int threads, Progress &progress)
        : team_(team), progress_(progress), threads_(threads) {
        if (!team.IsRank0()) return;
        left_ = {0, count};
        replies_ = std::thread([this] { Reply(); });
    }
    ~WorkDistributor() { Finish(); }

    /// Thread-safe. Empty: no numbers are left.
    std::optional<int64_t> Take() {
        if (team_.IsRank0()) {
            const Numbers taken = TakeFromCounter(1);
            return taken.begin < taken.end ? std::optional(taken.begin) : std::nullopt;
        }
        for (int tries = 0;; ++tries) {
            {
                std::lock_guard lock(mutex_);
                if (left_.begin < left_.end) {
                    const int64_t taken = left_.begin++;
                    if (!isWaiting_ && left_.end - left_.begin <= threads_) SendRequest();
                    return taken;
                }
                if (isOver_) return {};
                if (!isWaiting_) SendRequest();
                if (const auto message = team_.port_->TryReceive(0, Team::Channel::Replies)) {
                    const auto reply = StateReader(message->bytes, "reply").Value<Grant>();
                    isWaiting_ = false;
                    left_ = reply.numbers;
                    isOver_ = left_.begin == left_.end;
                    if (reply.isCancelled) progress_.Cancel();
                    continue;
                }
            }
            Pause(tries);
        }
    }
    /// Adds to the amount done; thread-safe. On rank 0 `progress` advances by the amounts of all ranks.
    void Report(int64_t amount) {
        if (team_.IsRank0()) return progress_.Advance(amount);
        std::lock_guard lock(mutex_);
        done_ += amount;
    }
    /// Called after the last Take; rank 0 waits for all others. Returns the reported amount that did not reach rank 0.
    int64_t Finish() {
        if (replies_.joinable()) replies_.join();
        return std::exchange(done_, 0);
    }

  private:
    struct Numbers {
        int64_t begin = 0, end = 0;
    };
    struct Request {
        int threads = 1;
        bool isCancelled = false;
        int64_t done = 0;
    };
    struct Grant {
        bool isCancelled = false;
        Numbers numbers;  ///< empty: no numbers are left
    };
    static constexpr int64_t kMaxPerThread = 4;

    static void Pause(int tries) {
        // The first replies are urgent; long waits must not take CPU time from workers.
        std::this_thread::sleep_for(std::chrono::microseconds(tries < 20 ? 50 : 1000));
    }
    void Reply() {
        int waiting = team_.Size() - 1;
        for (int tries = 0; waiting > 0; ++tries) {
            const std::optional<MessagePort::Message> message = team_.port_->TryReceive(-1, Team::Channel::Requests);
            if (!message) {
                Pause(tries);
                continue;
            }
            tries = 0;
            const auto request = StateReader(message->bytes, "request").Value<Request>();
            if (request.isCancelled) progress_.Cancel();
            progress_.Advance(request.done);
            int64_t left = 0;
            {
                std::lock_guard lock(mutex_);
                left = left_.end - left_.begin;
            }
            // A quarter of the process's share, so that all end at about the same time.
            const int64_t fraction = left * request.threads / (4 * int64_t{team_.TotalThreads()});
            const Numbers given =
                TakeFromCounter(std::clamp(fraction, int64_t{1}, kMaxPerThread * int64_t{request.threads}));
            if (given.begin == given.end) --waiting;
            StateWriter out;
            out(Grant{progress_.Cancelled(), given});
            team_.Send(message->from, Team::Channel::Replies, out);
        }
    }
    void SendRequest() {
        StateWriter out;
        out(Request{threads_, progress_.Cancelled(), std::exchange(done_, 0)});
        team_.Send(0, Team::Channel::Requests, out);
        isWaiting_ = true;
    }
    Numbers TakeFromCounter(int64_t maxCount) {
        std::lock_guard lock(mutex_);
        if (progress_.Cancelled()) left_.begin = left_.end;
        const int64_t begin = left_.begin;
        left_.begin = std::min(left_.end, begin + maxCount);
        return {begin, left_.begin};
    }

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
inline int64_t DistributeWork(Team &team, int64_t count, Progress &progress,
                              const std::function<int64_t(int64_t)> &work) {
    if (team.Size() == 1) {
        ParallelForEach(count, [&](int64_t i) {
            if (const int64_t amount = work(i); amount > 0) progress.Advance(amount);
        });
        return 0;
    }
    WorkDistributor distributor(team, count, ThreadCount(), progress);
    ParallelForEach(ThreadCount(), [&](int64_t) {
        while (const std::optional<int64_t> i = distributor.Take())
            if (const int64_t amount = work(*i); amount > 0) distributor.Report(amount);
    });
    return distributor.Finish();
}

}  // namespace pbrt
