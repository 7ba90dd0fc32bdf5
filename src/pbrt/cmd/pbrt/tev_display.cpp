#include "pbrt/cmd/pbrt/tev_display.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "pbrt/core/log.h"

namespace pbrt {

namespace {

static_assert(std::endian::native == std::endian::little, "the protocol is little-endian");

/// How long a viewer may take to answer, seconds.
constexpr int kConnectSeconds = 5;
/// How long a viewer that reads nothing is waited for after the end of the render; LiveView::kFarewellSeconds is
/// longer.
constexpr double kLastSeconds = 1.5;
/// Values of one update: small packets are shown while others are on their way.
constexpr int kMaxValues = 1 << 16;

/// One message: its bytes with their number before them, which counts itself.
class Packet {
  public:
    enum Type : char { CloseImage = 2, UpdateImage = 3, CreateImage = 4 };
    explicit Packet(Type type) : bytes_(sizeof(uint32_t), 0) { bytes_ += static_cast<char>(type); }
    Packet &Flag(bool v) {
        bytes_ += static_cast<char>(v);
        return *this;
    }
    Packet &Text(const std::string &text) {
        bytes_.append(text.c_str(), text.size() + 1);
        return *this;
    }
    Packet &Numbers(std::initializer_list<int32_t> numbers) { return Append(numbers.begin(), numbers.size()); }
    Packet &Values(const std::vector<float> &values) { return Append(values.data(), values.size()); }
    const std::string &Bytes() {
        const auto size = static_cast<uint32_t>(bytes_.size());
        std::memcpy(bytes_.data(), &size, sizeof(size));
        return bytes_;
    }

  private:
    template <class T>
    Packet &Append(const T *values, size_t count) {
        bytes_.append(reinterpret_cast<const char *>(values), count * sizeof(T));
        return *this;
    }
    std::string bytes_;
};

/// A connection with time-outs.
class Connection {
  public:
    Connection(const LiveBoard &board, const std::string &server) : board_(board) {
        const auto [host, port] = SplitServer(server);
        addrinfo hints = {}, *found = nullptr;
        hints.ai_socktype = SOCK_STREAM;
        if (const int code = getaddrinfo(host.c_str(), port.c_str(), &hints, &found); code != 0) {
            failure_ = gai_strerror(code);
            return;
        }
        for (const addrinfo *a = found; a && socket_ < 0; a = a->ai_next) Connect(*a);
        freeaddrinfo(found);
    }
    ~Connection() {
        if (socket_ >= 0) close(socket_);
    }
    Connection(const Connection &) = delete;
    Connection &operator=(const Connection &) = delete;

    bool IsOpen() const { return socket_ >= 0; }
    const std::string &Failure() const { return failure_; }

    /// False: the viewer is gone, or has read nothing for too long after the board was closed.
    bool Send(const std::string &bytes) {
        size_t sent = 0;
        while (sent < bytes.size()) {
            const ssize_t n = send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
            if (n > 0) {
                sent += static_cast<size_t>(n);
            } else if (n < 0 && errno == EINTR) {
                continue;
            } else if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
                if (!WaitToWrite()) return false;
            } else {
                failure_ = std::strerror(errno);
                return false;
            }
        }
        return true;
    }

  private:
    using Clock = std::chrono::steady_clock;

    void Connect(const addrinfo &address) {
        const int s =
            socket(address.ai_family, address.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, address.ai_protocol);
        if (s < 0) {
            failure_ = std::strerror(errno);
            return;
        }
        int reason = 0;
        if (connect(s, address.ai_addr, address.ai_addrlen) != 0) {
            reason = errno;
            pollfd ready = {s, POLLOUT, 0};
            socklen_t size = sizeof(reason);
            if (reason == EINPROGRESS && poll(&ready, 1, 1000 * kConnectSeconds) <= 0)
                reason = ETIMEDOUT;
            else if (reason == EINPROGRESS)
                getsockopt(s, SOL_SOCKET, SO_ERROR, &reason, &size);
        }
        if (reason != 0) {
            failure_ = std::strerror(reason);
            close(s);
            return;
        }
        socket_ = s;
    }
    /// False: nothing could be written for too long after the board was closed.
    bool WaitToWrite() {
        std::optional<Clock::time_point> closed;
        for (;;) {
            pollfd ready = {socket_, POLLOUT, 0};
            if (poll(&ready, 1, 50) > 0) return true;
            if (!board_.IsClosed()) continue;
            if (!closed) closed = Clock::now();
            if (std::chrono::duration<double>(Clock::now() - *closed).count() > kLastSeconds) {
                failure_ = "it reads nothing";
                return false;
            }
        }
    }

    const LiveBoard &board_;
    int socket_ = -1;
    std::string failure_;
};

constexpr const char *kChannels[3] = {"R", "G", "B"};

/// Sends a picture in strips, each channel in a packet of its own.
bool SendPicture(Connection &viewer, const LiveRender &render, const LivePicture &picture) {
    const Point2i resolution = picture.colors.Resolution(), low = render.pixelBounds.low;
    const int rows = std::max(1, kMaxValues / std::max(1, resolution.x));
    std::vector<float> values;
    for (int y = 0; y < resolution.y; y += rows) {
        const int height = std::min(rows, resolution.y - y);
        for (int c = 0; c < 3; ++c) {
            values.clear();
            for (int row = y; row < y + height; ++row)
                for (int x = 0; x < resolution.x; ++x) values.push_back(picture.colors.Get({x, row}, c));
            Packet packet(Packet::UpdateImage);
            packet.Flag(false).Text(render.filename).Text(kChannels[c]);
            packet.Numbers({low.x, low.y + y, resolution.x, height}).Values(values);
            if (!viewer.Send(packet.Bytes())) return false;
        }
    }
    return true;
}

/// A picture of the same name, of an earlier render, is closed first: it may have another size.
bool SendBeginning(Connection &viewer, const LiveRender &render) {
    Packet create(Packet::CreateImage);
    create.Flag(true).Text(render.filename);
    create.Numbers({render.fullResolution.x, render.fullResolution.y, 3});
    for (const char *channel : kChannels) create.Text(channel);
    return viewer.Send(Packet(Packet::CloseImage).Text(render.filename).Bytes()) && viewer.Send(create.Bytes());
}

}  // namespace

std::pair<std::string, std::string> SplitServer(const std::string &server) {
    const size_t colon = server.rfind(':');
    if (colon == std::string::npos || colon == 0) return {};
    std::string host = server.substr(0, colon), port = server.substr(colon + 1);
    if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
    const bool isNumber = !port.empty() && port.size() <= 5 &&
                          std::all_of(port.begin(), port.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!isNumber || std::stoi(port) < 1 || std::stoi(port) > 65535) return {};
    return {host, port};
}

void ShowInTev(LiveBoard &board, const std::string &server) {
    Connection viewer(board, server);
    const auto complain = [&](const char *what) {
        LogWarning(fmt::format("--display-server {}: {} ({}); the render continues without it.", server, what,
                               viewer.Failure()));
    };
    if (!viewer.IsOpen()) return complain("no viewer answers");
    int version = 0;
    double charged = 0;
    for (;;) {
        const std::shared_ptr<const LivePicture> picture = board.WaitBeyond(version, 3600);
        const bool isNew = picture && picture->version > version;
        if (!isNew && board.IsClosed()) return;
        if (!isNew) continue;
        const std::optional<LiveRender> render = board.Render();
        if (!render) continue;
        if (version == 0 && !SendBeginning(viewer, *render)) return complain("the viewer is gone");
        if (!SendPicture(viewer, *render, *picture)) return complain("the viewer is gone");
        version = picture->version;
        const double cpu = ThreadCpuSeconds();
        board.Charge(cpu - charged);
        charged = cpu;
        if (picture->IsFinal()) return;
    }
}

}  // namespace pbrt
