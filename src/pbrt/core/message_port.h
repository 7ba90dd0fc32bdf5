#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>

// Interface to MPI. Loading MPI's libraries takes longer than a small render, so mpi_module.cpp is a separate library,
// loaded only under mpirun. Only plain data crosses the interface, and this header includes no other project header.
// Used by Team only.
namespace pbrt {

/// Byte transport between the processes of one job. For one thread at a time. Errors abort the job with MPI's message.
class MessagePort {
  public:
    /// Messages of different channels are independent.
    enum class Channel { Together, Requests, Replies };
    struct Message {
        int from = 0;
        std::string bytes;
    };

    /// Collective: disconnects once all processes do.
    virtual ~MessagePort() = default;
    virtual int Rank() const = 0;
    virtual int Size() const = 0;
    /// Returns when the bytes may be changed. The message is the concatenation of `pieces`.
    virtual void Send(int to, Channel channel, std::span<const std::string_view> pieces) = 0;
    /// Returns the next message of one sender, or of any (-1), if available. Messages of one sender keep their order.
    virtual std::optional<Message> TryReceive(int from, Channel channel) = 0;
    virtual void Abort(int status) = 0;
};

}  // namespace pbrt
