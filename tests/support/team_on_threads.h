#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "pbrt/core/team.h"

// Teams whose processes are threads of one process and exchange messages through a port of our own.
namespace pbrt::test {

struct Mail {
    std::mutex mutex;
    struct Letter {
        int to;
        MessagePort::Channel channel;
        MessagePort::Message message;
    };
    std::deque<Letter> letters;

    /// True if a letter was sent to this rank but not received yet.
    bool IsWaiting(int to, MessagePort::Channel channel) {
        std::lock_guard lock(mutex);
        return std::any_of(letters.begin(), letters.end(),
                           [&](const Letter &l) { return l.to == to && l.channel == channel; });
    }
};

class ThreadPort final : public MessagePort {
  public:
    ThreadPort(Mail &mail, int rank, int size) : mail_(mail), rank_(rank), size_(size) {}
    int Rank() const override { return rank_; }
    int Size() const override { return size_; }
    void Send(int to, Channel channel, std::span<const std::string_view> pieces) override {
        std::string bytes;
        for (const std::string_view piece : pieces) bytes += piece;
        std::lock_guard lock(mail_.mutex);
        mail_.letters.push_back({to, channel, {rank_, bytes}});
    }
    std::optional<Message> TryReceive(int from, Channel channel) override {
        std::lock_guard lock(mail_.mutex);
        for (auto it = mail_.letters.begin(); it != mail_.letters.end(); ++it)
            if (it->to == rank_ && it->channel == channel && (from < 0 || it->message.from == from)) {
                Message message = it->message;
                mail_.letters.erase(it);
                return message;
            }
        return {};
    }
    void Abort(int) override { FAIL() << "aborted"; }

  private:
    Mail &mail_;
    const int rank_, size_;
};

/// Runs `act` on all ranks of a team at once, and expects that all messages were received.
inline void WithTeam(Mail &mail, int size, const std::function<void(Team &)> &act) {
    std::vector<std::thread> threads;
    for (int r = 0; r < size; ++r)
        threads.emplace_back([&, r] {
            Team team(std::make_unique<ThreadPort>(mail, r, size), 1 + r % 2);
            act(team);
        });
    for (std::thread &t : threads) t.join();
    EXPECT_TRUE(mail.letters.empty());
}
inline void WithTeam(int size, const std::function<void(Team &)> &act) {
    Mail mail;
    WithTeam(mail, size, act);
}

}  // namespace pbrt::test
