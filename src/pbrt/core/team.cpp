#include "pbrt/core/team.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <map>
#include <thread>
#include <utility>

#include "pbrt/core/parallel.h"
#include "pbrt/core/version.h"

namespace pbrt {
namespace {

std::string HostName() {
    char name[256] = "";
    gethostname(name, sizeof(name) - 1);
    return name;
}

}  // namespace

Team::Team(std::unique_ptr<MessagePort> port, int threads) : port_(std::move(port)), totalThreads_(threads) {
    const std::string mine = BuildId();
    std::string other;
    Reduce([&](StateWriter &out) { out(totalThreads_, other.empty() ? mine : other); },
           [&](StateReader &in) {
               totalThreads_ += in.Value<int>();
               if (const std::string theirs = in.Text(); theirs != mine) other = theirs;
           });
    totalThreads_ = BroadcastValue(totalThreads_);
    if (!BroadcastValue(!other.empty())) return;
    port_.reset();
    if (!other.empty()) throw UserError("the processes that mpirun started do not all run the same build of pbrt.");
    throw AnotherRankFailed{};
}

int Team::TotalThreads() const { return port_ ? totalThreads_ : ThreadCount(); }

std::string Team::Receive(int from) {
    // Sleeps instead of spinning, to leave the core to others.
    for (int tries = 0;; ++tries) {
        if (std::optional<MessagePort::Message> message = port_->TryReceive(from, Channel::Together))
            return std::move(message->bytes);
        if (tries > 20) std::this_thread::sleep_for(std::chrono::microseconds(tries < 200 ? 20 : 500));
    }
}

std::string Team::Broadcast(const StateWriter &bytes) {
    // Binary tree: the parent of rank r is r without its highest bit; its children have one further bit above it.
    const int rank = Rank(), size = Size();
    int bit = 1;
    std::string received;
    if (rank > 0) {
        while (2 * bit <= rank) bit *= 2;
        received = Receive(rank - bit);
        bit *= 2;
    } else {
        received = bytes.Joined();
    }
    StateWriter out;
    out.Refer(received.data(), received.size());
    for (; rank + bit < size; bit *= 2) Send(rank + bit, Channel::Together, out);
    return received;
}

void Team::Reduce(const std::function<void(StateWriter &)> &take, const std::function<void(StateReader &)> &add) {
    const int rank = Rank(), size = Size();
    for (int bit = 1; bit < size; bit *= 2) {
        if (rank & bit) {
            StateWriter out;
            take(out);
            Send(rank - bit, Channel::Together, out);
            return;
        }
        if (rank + bit >= size) continue;
        const std::string bytes = Receive(rank + bit);
        StateReader in(bytes, fmt::format("message of process {}", rank + bit));
        add(in);
    }
}

std::optional<std::string> Team::Failures(const std::string &mine) {
    struct Processes {
        uint64_t count = 0;
        std::string first;
    };
    std::map<std::string, Processes> failures;
    if (!mine.empty()) failures[mine] = {1, fmt::format("{} on {}", Rank(), HostName())};
    Reduce(
        [&](StateWriter &out) {
            out(uint64_t{failures.size()});
            for (const auto &[text, processes] : failures) out(text, processes.count, processes.first);
        },
        [&](StateReader &in) {
            for (auto texts = in.Value<uint64_t>(); texts > 0; --texts) {
                auto &[count, first] = failures[in.Text()];
                count += in.Value<uint64_t>();
                if (const std::string theirs = in.Text(); first.empty()) first = theirs;
            }
        });
    if (!BroadcastValue(!failures.empty())) return {};
    std::string text;
    if (IsRank0())
        for (const auto &[what, processes] : failures)
            if (what != mine)
                text += fmt::format("{} of {} processes (the first is {}) failed: {}", processes.count, Size(),
                                    processes.first, what);
    return text;
}

void Team::Fail(const UserError &error) {
    if (Size() == 1 || std::exchange(isEnding_, true)) return;
    const std::string text = FormatAll(error, false);
    if (!meets_) {
        std::fputs(text.c_str(), stderr);
        Abort(1);
    }
    std::fputs(Failures(text)->c_str(), stderr);
}

}  // namespace pbrt
