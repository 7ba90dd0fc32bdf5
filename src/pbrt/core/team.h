#pragma once
#include <functional>
#include <memory>
#include <string>

#include "pbrt/core/error.h"
#include "pbrt/core/message_port.h"
#include "pbrt/core/state_io.h"

namespace pbrt {

/// Thrown by Team::Meet where another process reports the error.
struct AnotherRankFailed {};

/// The processes of one job that render one image together, and their collective operations. Rank 0 alone writes files
/// and messages. Broadcast, Reduce, AllReduce and Meet are called by all processes in the same order, each on one
/// thread. A process that mpirun did not start is a team of one, for which all of them are free.
class Team {
  public:
    /// This process alone.
    Team() = default;
    /// `threads`: of this process.
    Team(std::unique_ptr<MessagePort> port, int threads);
    ~Team();
    /// A team of one for any number of renders.
    static Team &Alone();

    int Rank() const { return port_ ? port_->Rank() : 0; }
    int Size() const { return port_ ? port_->Size() : 1; }
    bool IsRank0() const { return Rank() == 0; }
    /// Of all processes.
    int TotalThreads() const;

    /// Returns the bytes of rank 0; those of other ranks are ignored. Uses a binary tree.
    std::string Broadcast(const StateWriter &bytes);
    /// Returns the value of rank 0.
    template <class T>
    T BroadcastValue(const T &value) {
        StateWriter out;
        out.Value(value);
        const std::string bytes = Broadcast(out);
        return StateReader(bytes, "message").Value<T>();
    }
    /// Brings the data of all processes to rank 0, up a binary tree: `take` writes the data of this process including
    /// its children's, which `add` read before. Rank 0 does not call `take`.
    void Reduce(const std::function<void(StateWriter &)> &take, const std::function<void(StateReader &)> &add);
    /// Brings the data of all processes to all of them: Reduce, then every process adds what `take` removed from rank
    /// 0.
    void AllReduce(const std::function<void(StateWriter &)> &take, const std::function<void(StateReader &)> &add);
    /// Returns if no process has failed; otherwise throws UserError on rank 0 (unless it reported all failures itself)
    /// and AnotherRankFailed on the others.
    void Meet();
    /// Takes the place of the next Meet in a process that failed with `error` and does nothing more. Returns when all
    /// others have the error. Rank 0 prints the errors of the others, but not its own; the others print nothing. Does
    /// nothing if the error came from Meet.
    void Fail(const UserError &error);
    /// After this call there are no further meetings: Fail ends the job.
    void EndMeetings() { meets_ = false; }

    /// Bytes that this process has sent.
    uint64_t BytesSent() const { return bytesSent_; }
    /// Ends all processes of the job; a team of one goes on.
    void Abort(int status);

  private:
    friend class WorkDistributor;
    using Channel = MessagePort::Channel;
    void Send(int to, Channel channel, const StateWriter &bytes);
    std::string Receive(int from);
    /// The failures with their processes; empty except on rank 0.
    std::string Failures(const std::string &mine, bool *isAny);

    std::unique_ptr<MessagePort> port_;  ///< null: this process alone
    int totalThreads_ = 0;
    bool meets_ = true, isEnding_ = false;
    uint64_t bytesSent_ = 0;
};

/// The number of processes that mpirun announces in the environment, of which this is number `rank`.
struct AnnouncedTeam {
    int rank = 0, size = 1;
    int onThisMachine = 1;
};
AnnouncedTeam ReadAnnouncedTeam();

/// Connects this process with the others of its job, if there are others. Throws UserError if this program was built
/// without MPI.
std::unique_ptr<Team> ConnectTeam(int threads);

}  // namespace pbrt
