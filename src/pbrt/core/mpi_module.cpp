// All code that calls MPI. See message_port.h.
#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>
#include <vector>

#include "pbrt/core/message_port.h"

namespace pbrt {

namespace {

/// Longer messages are sent in parts: MPI counts with int.
constexpr size_t kLargestPart = size_t{1} << 26;

class MpiPort final : public MessagePort {
  public:
    MpiPort() {
        // Only one thread at a time calls MPI, but not always the same.
        int provided = MPI_THREAD_SINGLE;
        MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided);
        if (provided < MPI_THREAD_SERIALIZED) MPI_Abort(MPI_COMM_WORLD, 1);
        MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
        MPI_Comm_size(MPI_COMM_WORLD, &size_);
    }
    ~MpiPort() override { MPI_Finalize(); }

    int Rank() const override { return rank_; }
    int Size() const override { return size_; }

    void Send(int to, Channel channel, std::span<const std::string_view> pieces) override {
        // The length, then the bytes in parts of the largest size but for the last.
        uint64_t length = 0;
        for (const std::string_view piece : pieces) length += piece.size();
        SendPart(to, channel, &length, sizeof(length));
        std::vector<char> part;
        for (std::string_view piece : pieces)
            while (!piece.empty()) {
                if (part.empty() && piece.size() >= kLargestPart) {
                    SendPart(to, channel, piece.data(), kLargestPart);
                    piece.remove_prefix(kLargestPart);
                    continue;
                }
                const size_t take = std::min(piece.size(), kLargestPart - part.size());
                part.insert(part.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(take));
                piece.remove_prefix(take);
                if (part.size() < kLargestPart) continue;
                SendPart(to, channel, part.data(), part.size());
                part.clear();
            }
        if (!part.empty()) SendPart(to, channel, part.data(), part.size());
    }

    std::optional<Message> TryReceive(int from, Channel channel) override {
        const int source = from < 0 ? MPI_ANY_SOURCE : from;
        int hasCome = 0;
        MPI_Message matched;
        MPI_Status status;
        MPI_Improbe(source, static_cast<int>(channel), MPI_COMM_WORLD, &hasCome, &matched, &status);
        if (!hasCome) return {};
        uint64_t length = 0;
        MPI_Mrecv(&length, sizeof(length), MPI_BYTE, &matched, MPI_STATUS_IGNORE);
        Message message{status.MPI_SOURCE, std::string(length, 0)};
        for (size_t at = 0; at < length; at += kLargestPart) {
            MPI_Request request;
            MPI_Irecv(message.bytes.data() + at, static_cast<int>(std::min(kLargestPart, length - at)), MPI_BYTE,
                      message.from, static_cast<int>(channel), MPI_COMM_WORLD, &request);
            WaitFor(request);
        }
        return message;
    }

    void Abort(int status) override {
        MPI_Abort(MPI_COMM_WORLD, status);
        std::_Exit(status);
    }

  private:
    static void SendPart(int to, Channel channel, const void *data, size_t bytes) {
        MPI_Request request;
        MPI_Isend(data, static_cast<int>(bytes), MPI_BYTE, to, static_cast<int>(channel), MPI_COMM_WORLD, &request);
        WaitFor(request);
    }
    /// MPI_Wait would keep a core busy.
    static void WaitFor(MPI_Request &request) {
        for (int tries = 0;; ++tries) {
            int isDone = 0;
            MPI_Test(&request, &isDone, MPI_STATUS_IGNORE);
            if (isDone) return;
            if (tries > 100) std::this_thread::sleep_for(std::chrono::microseconds(20));
        }
    }
    int rank_ = 0, size_ = 1;
};

}  // namespace

}  // namespace pbrt

extern "C" [[gnu::visibility("default")]] pbrt::MessagePort *PbrtMessagePort() { return new pbrt::MpiPort; }
