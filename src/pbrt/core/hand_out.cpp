#include "pbrt/core/hand_out.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace pbrt {

namespace {

/// A process gets at most so many numbers per thread at once.
constexpr int64_t kMaxPerThread = 4;

struct Request {
    int threads = 1;
    bool isCancelled = false;
    int64_t done = 0;
};

struct Reply {
    bool isCancelled = false;
    int64_t begin = 0, end = 0;  ///< equal: there is nothing left
};

void Pause(int tries) {
    // The first answers are wanted soon; a long wait must not cost the time of those who work.
    std::this_thread::sleep_for(std::chrono::microseconds(tries < 20 ? 50 : 1000));
}

}  // namespace

HandOut::HandOut(Ranks &ranks, int64_t count, int threads, Progress &progress)
    : ranks_(ranks), progress_(progress), threads_(threads) {
    if (!ranks.IsFirst()) return;
    left_ = {0, count};
    answers_ = std::thread([this] { Answer(); });
}

HandOut::~HandOut() { Finish(); }

HandOut::Numbers HandOut::TakeFromCounter(int64_t most) {
    std::lock_guard lock(mutex_);
    if (progress_.Cancelled()) left_.begin = left_.end;
    const int64_t begin = left_.begin;
    left_.begin = std::min(left_.end, begin + most);
    return {begin, left_.begin};
}

void HandOut::Answer() {
    int asking = ranks_.Size() - 1;
    for (int tries = 0; asking > 0; ++tries) {
        const std::optional<MessagePort::Message> message = ranks_.port_->TryReceive(-1, Ranks::Channel::Requests);
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
        // A quarter of the share of what is left, so that all end at about the same time.
        const int64_t share = left * request.threads / (4 * int64_t{ranks_.TotalThreads()});
        const Numbers given = TakeFromCounter(std::clamp(share, int64_t{1}, kMaxPerThread * int64_t{request.threads}));
        if (given.begin == given.end) --asking;
        StateWriter out;
        out.Value(Reply{progress_.Cancelled(), given.begin, given.end});
        ranks_.Send(message->from, Ranks::Channel::Answers, out);
    }
}

void HandOut::Ask() {
    StateWriter out;
    out.Value(Request{threads_, progress_.Cancelled(), std::exchange(done_, 0)});
    ranks_.Send(0, Ranks::Channel::Requests, out);
    isAsking_ = true;
}

std::optional<int64_t> HandOut::Take() {
    if (ranks_.IsFirst()) {
        const Numbers taken = TakeFromCounter(1);
        return taken.begin < taken.end ? std::optional(taken.begin) : std::nullopt;
    }
    for (int tries = 0;; ++tries) {
        {
            std::lock_guard lock(mutex_);
            if (left_.begin < left_.end) {
                const int64_t taken = left_.begin++;
                if (!isAsking_ && left_.end - left_.begin <= threads_) Ask();
                return taken;
            }
            if (isOver_) return {};
            if (!isAsking_) Ask();
            if (const auto message = ranks_.port_->TryReceive(0, Ranks::Channel::Answers)) {
                const auto reply = StateReader(message->bytes, "answer").Value<Reply>();
                isAsking_ = false;
                left_ = {reply.begin, reply.end};
                isOver_ = reply.begin == reply.end;
                if (reply.isCancelled) progress_.Cancel();
                continue;
            }
        }
        Pause(tries);
    }
}

void HandOut::Report(int64_t amount) {
    if (ranks_.IsFirst()) {
        progress_.Advance(amount);
        return;
    }
    std::lock_guard lock(mutex_);
    done_ += amount;
}

int64_t HandOut::Finish() {
    if (answers_.joinable()) answers_.join();
    return std::exchange(done_, 0);
}

}  // namespace pbrt
