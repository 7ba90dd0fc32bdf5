// All MPI calls. See message_port.h.
#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "pbrt/core/message_port.h"

namespace pbrt {
namespace {

/// Longer messages are fragmented, because MPI counts with int.
constexpr size_t kMaxFragment = size_t{1} << 26;
/// Bytes; longer messages are sent only when the receiver is ready.
constexpr size_t kShort = size_t{1} << 16;

class MpiPort final : public MessagePort {
  public:
    MpiPort() {
        // One thread at a time calls MPI, but not always the same one.
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
        // The length, then fragments: large pieces directly, small ones gathered.
        uint64_t length = 0;
        for (const std::string_view piece : pieces) length += piece.size();
        MPI_Request request;
        const auto begin = length > kShort ? MPI_Issend : MPI_Isend;
        begin(&length, sizeof(length), MPI_BYTE, to, int(channel), MPI_COMM_WORLD, &request);
        WaitPatiently(request);
        std::string small;
        const auto sendSmall = [&] {
            if (!small.empty()) SendFragment(to, channel, small);
            small.clear();
        };
        for (std::string_view piece : pieces) {
            if (piece.size() < kShort) {
                small += piece;
                if (small.size() >= kShort) sendSmall();
                continue;
            }
            sendSmall();
            for (; !piece.empty(); piece.remove_prefix(std::min(kMaxFragment, piece.size())))
                SendFragment(to, channel, piece.substr(0, kMaxFragment));
        }
        sendSmall();
    }

    std::optional<Message> TryReceive(int from, Channel channel) override {
        const int source = from < 0 ? MPI_ANY_SOURCE : from;
        int hasCome = 0;
        MPI_Message matched;
        MPI_Status status;
        MPI_Improbe(source, int(channel), MPI_COMM_WORLD, &hasCome, &matched, &status);
        if (!hasCome) return {};
        uint64_t length = 0;
        MPI_Mrecv(&length, sizeof(length), MPI_BYTE, &matched, MPI_STATUS_IGNORE);
        Message message{status.MPI_SOURCE, std::string(length, 0)};
        for (size_t at = 0; at < length;) {
            // The sender chooses the fragment lengths.
            MPI_Message fragment;
            for (hasCome = 0; !hasCome; std::this_thread::yield())
                MPI_Improbe(message.from, int(channel), MPI_COMM_WORLD, &hasCome, &fragment, &status);
            int bytes = 0;
            MPI_Get_count(&status, MPI_BYTE, &bytes);
            MPI_Request request;
            MPI_Imrecv(message.bytes.data() + at, bytes, MPI_BYTE, &fragment, &request);
            WaitBusily(request);
            at += bytes;
        }
        return message;
    }

    void Abort(int status) override {
        MPI_Abort(MPI_COMM_WORLD, status);
        std::_Exit(status);
    }

  private:
    static void SendFragment(int to, Channel channel, std::string_view bytes) {
        MPI_Request request;
        MPI_Isend(bytes.data(), int(bytes.size()), MPI_BYTE, to, int(channel), MPI_COMM_WORLD, &request);
        WaitBusily(request);
    }
    static bool IsDone(MPI_Request &request) {
        int isDone = 0;
        MPI_Test(&request, &isDone, MPI_STATUS_IGNORE);
        return isDone != 0;
    }
    /// For a peer that may be busy for long; MPI_Wait would spin meanwhile.
    static void WaitPatiently(MPI_Request &request) {
        for (int tries = 0; !IsDone(request); ++tries)
            if (tries > 100) std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
    /// For active transfers, which progress only inside MPI calls.
    static void WaitBusily(MPI_Request &request) {
        while (!IsDone(request)) std::this_thread::yield();
    }
    int rank_ = 0, size_ = 1;
};

}  // namespace
}  // namespace pbrt

extern "C" [[gnu::visibility("default")]] pbrt::MessagePort *PbrtMessagePort() { return new pbrt::MpiPort; }
