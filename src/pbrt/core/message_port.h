#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

// The interface to MPI. Its libraries take longer to load than a small render takes, so the code that calls them is a
// separate library (mpi_module.cpp), loaded only in processes that mpirun started. The two sides share plain data only;
// this header includes no other header of the project. Team uses it, nothing else.
namespace pbrt {

/// Sends bytes between the processes of one job. One thread at a time may call. Errors end the whole job with MPI's
/// message.
class MessagePort {
  public:
    /// Messages of different channels do not wait for each other.
    enum class Channel { Together, Requests, Replies };
    struct Message {
        int from = 0;
        std::string bytes;
    };

    /// Ends the connection, once all processes do.
    virtual ~MessagePort() = default;
    virtual int Rank() const = 0;
    virtual int Size() const = 0;
    /// Returns when the bytes may be changed. The message is all of them, one after the other.
    virtual void Send(int to, Channel channel, std::span<const std::string_view> pieces) = 0;
    /// The next message of one sender, or of any (-1), if one has come. Messages of one sender keep their order.
    virtual std::optional<Message> TryReceive(int from, Channel channel) = 0;
    /// Ends the processes of the whole job.
    virtual void Abort(int status) = 0;
};

}  // namespace pbrt
