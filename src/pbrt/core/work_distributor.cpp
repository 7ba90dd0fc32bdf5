#include "pbrt/core/work_distributor.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "pbrt/core/parallel.h"

namespace pbrt {
namespace {

constexpr int64_t kMaxPerThread = 4;

struct Request {
    int threads = 1;
    bool isCancelled = false;
    int64_t done = 0;
};

struct Answer {
    bool isCancelled = false;
    int64_t begin = 0, end = 0;  ///< equal: no numbers are left
};

void Pause(int tries) {
    // The first replies are urgent; long waits must not take CPU time from workers.
    std::this_thread::sleep_for(std::chrono::microseconds(tries < 20 ? 50 : 1000));
}

}  // namespace

WorkDistributor::WorkDistributor(Team &team, int64_t count, int threads, Progress &progress)
    : team_(team), progress_(progress), threads_(threads) {
    if (!team.IsRank0()) return;
    left_ = {0, count};
    replies_ = std::thread([this] { Reply(); });
}

WorkDistributor::~WorkDistributor() { Finish(); }

WorkDistributor::Numbers WorkDistributor::TakeFromCounter(int64_t most) {
    std::lock_guard lock(mutex_);
    if (progress_.Cancelled()) left_.begin = left_.end;
    const int64_t begin = left_.begin;
    left_.begin = std::min(left_.end, begin + most);
    return {begin, left_.begin};
}

void WorkDistributor::Reply() {
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
        out.Value(Answer{progress_.Cancelled(), given.begin, given.end});
        team_.Send(message->from, Team::Channel::Replies, out);
    }
}

void WorkDistributor::SendRequest() {
    StateWriter out;
    out.Value(Request{threads_, progress_.Cancelled(), std::exchange(done_, 0)});
    team_.Send(0, Team::Channel::Requests, out);
    isWaiting_ = true;
}

std::optional<int64_t> WorkDistributor::Take() {
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
                const auto reply = StateReader(message->bytes, "reply").Value<Answer>();
                isWaiting_ = false;
                left_ = {reply.begin, reply.end};
                isOver_ = reply.begin == reply.end;
                if (reply.isCancelled) progress_.Cancel();
                continue;
            }
        }
        Pause(tries);
    }
}

void WorkDistributor::Report(int64_t amount) {
    if (team_.IsRank0()) {
        progress_.Advance(amount);
        return;
    }
    std::lock_guard lock(mutex_);
    done_ += amount;
}

int64_t WorkDistributor::Finish() {
    if (replies_.joinable()) replies_.join();
    return std::exchange(done_, 0);
}

int64_t DistributeWork(Team &team, int64_t count, Progress &progress, const std::function<int64_t(int64_t)> &work) {
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
