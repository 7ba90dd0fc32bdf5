#pragma once
#include <functional>
#include <memory>
#include <string>

#include "pbrt/core/error.h"
#include "pbrt/core/message_port.h"
#include "pbrt/core/state_io.h"

namespace pbrt {

/// Thrown by Ranks::Meet where another process has said, or will say, what went wrong.
struct AnotherRankFailed {};

/// The processes of one job that render one picture together, and what they do together. Process 0 is the first: it
/// alone writes files and messages. Broadcast, Reduce and Meet are called by all processes in the same order, each on
/// one thread. A program that nobody started as one of many has no object of this class.
class Ranks {
  public:
    /// `threads`: of this process.
    Ranks(std::unique_ptr<MessagePort> port, int threads);
    ~Ranks();

    int Rank() const { return port_->Rank(); }
    int Size() const { return port_->Size(); }
    bool IsFirst() const { return Rank() == 0; }
    /// Of all processes.
    int TotalThreads() const { return totalThreads_; }

    /// Returns the bytes of the first process; those of the others are ignored. Goes down a binary tree.
    std::string Broadcast(const StateWriter &bytes);
    /// Brings what all processes have to the first, up a binary tree: `take` writes what this process has, its
    /// children's included, which were given to `add` before. The first process does not call `take`.
    void Reduce(const std::function<void(StateWriter &)> &take, const std::function<void(StateReader &)> &add);
    /// Ends well where no process has a failure to report; else throws AnotherRankFailed, but on the first process
    /// UserError, unless the only failures are those it reported itself.
    void Meet();
    /// In place of the next Meet: this process failed with that error, and has nothing more to do. Returns when the
    /// others know. The first process prints what failed on others, but not its own error; the others print nothing.
    /// Does nothing if the error came from Meet.
    void Fail(const UserError &error);
    /// No failure is expected from here on: Fail ends the job.
    void EndMeetings() { meets_ = false; }

    /// Bytes that this process has sent until now.
    uint64_t BytesSent() const { return bytesSent_; }
    void Abort(int status) { port_->Abort(status); }

  private:
    friend class HandOut;
    using Channel = MessagePort::Channel;
    void Send(int to, Channel channel, const StateWriter &bytes);
    std::string Receive(int from);
    /// What failed, on which processes; empty on others than the first.
    std::string Failures(const std::string &mine, bool *isAny);

    std::unique_ptr<MessagePort> port_;
    int totalThreads_ = 0;
    bool meets_ = true, isEnding_ = false;
    uint64_t bytesSent_ = 0;
};

/// How many processes mpirun says it started, of which this is number `rank`; from the environment.
struct RanksAnnounced {
    int rank = 0, size = 1;
    int onThisMachine = 1;
};
RanksAnnounced AnnouncedRanks();

/// Connects this process with the others of its job; null if there are no others. Throws UserError if this program was
/// built without MPI.
std::unique_ptr<Ranks> ConnectRanks(int threads);

}  // namespace pbrt
