#pragma once
#include <functional>
#include <memory>
#include <string>

#include "pbrt/core/error.h"
#include "pbrt/core/message_port.h"
#include "pbrt/core/state_io.h"

namespace pbrt {

/// Thrown by Team::Meet where another rank reports the error.
struct AnotherRankFailed {};

/// The processes of one job that render one image, with collective operations. Rank 0 alone writes files and messages.
/// Broadcast, Reduce, AllReduce and Meet are called by all ranks in the same order, on one thread each. Without mpirun
/// it is a team of one, for which all of them are free.
class Team {
  public:
    Team() = default;
    Team(std::unique_ptr<MessagePort> port, int threads);
    static Team &Alone() {
        static Team alone;
        return alone;
    }

    int Rank() const { return port_ ? port_->Rank() : 0; }
    int Size() const { return port_ ? port_->Size() : 1; }
    bool IsRank0() const { return Rank() == 0; }
    int TotalThreads() const;

    /// Returns the bytes of rank 0 on all ranks; other arguments are ignored. Uses a binary tree.
    std::string Broadcast(const StateWriter &bytes);
    template <class T>
    T BroadcastValue(const T &value) {
        StateWriter out;
        out.Value(value);
        const std::string bytes = Broadcast(out);
        return StateReader(bytes, "message").Value<T>();
    }
    /// Reduces to rank 0 along a binary tree: `take` writes a rank's data including its children's, which `add` merged.
    /// Rank 0 does not call `take`.
    void Reduce(const std::function<void(StateWriter &)> &take, const std::function<void(StateReader &)> &add);
    /// Reduce, then all ranks add the data that `take` extracts on rank 0.
    void AllReduce(const std::function<void(StateWriter &)> &take, const std::function<void(StateReader &)> &add) {
        if (Size() == 1) return;
        Reduce(take, add);
        StateWriter all;
        if (IsRank0()) take(all);
        const std::string bytes = Broadcast(all);
        StateReader in(bytes, "message");
        add(in);
    }
    /// Returns if no rank has failed; otherwise throws UserError on rank 0 (unless it reported all failures already)
    /// and AnotherRankFailed on the others.
    void Meet() {
        const std::optional<std::string> failures = Failures("");
        if (!failures) return;
        isEnding_ = true;
        if (IsRank0()) throw UserError(*failures);
        throw AnotherRankFailed{};
    }
    /// Takes the place of the next Meet on a rank that failed with `error`. Returns when all others have the error.
    /// Rank 0 prints the others' errors, but not its own; the others print nothing. Does nothing if the error came from
    /// Meet.
    void Fail(const UserError &error);
    /// Ends the sequence of meetings: from now on Fail aborts the job.
    void EndMeetings() { meets_ = false; }

    uint64_t BytesSent() const { return bytesSent_; }
    /// Aborts all processes of the job; no effect for a team of one.
    void Abort(int status) {
        if (port_) port_->Abort(status);
    }

  private:
    friend class WorkDistributor;
    using Channel = MessagePort::Channel;
    void Send(int to, Channel channel, const StateWriter &bytes) {
        bytesSent_ += bytes.Bytes();
        port_->Send(to, channel, bytes.Pieces());
    }
    std::string Receive(int from);
    /// Failures of the other ranks, as text on rank 0; nothing if no rank failed. `mine`: empty if this one did not.
    std::optional<std::string> Failures(const std::string &mine);

    std::unique_ptr<MessagePort> port_;  ///< null: team of one
    int totalThreads_ = 0;
    bool meets_ = true, isEnding_ = false;
    uint64_t bytesSent_ = 0;
};

/// Team size and rank as announced by mpirun in the environment.
struct AnnouncedTeam {
    int rank = 0, size = 1, onThisMachine = 1;
};
AnnouncedTeam ReadAnnouncedTeam();

/// Connects the processes of the job. Throws UserError if built without MPI but started as one of several processes.
std::unique_ptr<Team> ConnectTeam(int threads);

}  // namespace pbrt
