#include "pbrt/cmd/pbrt/live_view.h"

#include <bit>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <cstring>

#include "pbrt/core/log.h"

namespace pbrt {
namespace {

namespace beast = boost::beast;
using boost::asio::ip::tcp;

static_assert(std::endian::native == std::endian::little, "the protocol is little-endian");

constexpr int kConnectSeconds = 5;    ///< time-out
constexpr double kLastSeconds = 1.5;  ///< for a stalled viewer after the render; below LiveView::kFarewellSeconds
constexpr int kMaxValues = 1 << 16;   ///< per update: small packets overlap transfer and display

/// A message, prefixed by its size in bytes including the prefix.
class Packet {
  public:
    enum Type : char { CloseImage = 2, UpdateImage = 3, CreateImage = 4 };
    explicit Packet(Type type) : bytes_(sizeof(uint32_t), 0) { bytes_ += char(type); }
    Packet &Flag(bool v) {
        bytes_ += char(v);
        return *this;
    }
    Packet &Text(const std::string &text) {
        bytes_.append(text.c_str(), text.size() + 1);
        return *this;
    }
    Packet &Numbers(std::initializer_list<int32_t> numbers) { return Append(numbers.begin(), numbers.size()); }
    Packet &Values(const std::vector<float> &values) { return Append(values.data(), values.size()); }
    const std::string &Bytes() {
        const auto size = uint32_t(bytes_.size());
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

class Connection {
  public:
    Connection(const LiveBoard &board, const std::string &server) : board_(board) {
        const auto [host, port] = SplitServer(server);
        const auto found = tcp::resolver(io_).resolve(host, port, failed_);
        if (failed_) return;
        stream_.expires_after(std::chrono::seconds(kConnectSeconds));
        stream_.async_connect(found, [this](beast::error_code failed, const tcp::endpoint &) { failed_ = failed; });
        io_.run();
        stream_.expires_never();
    }

    bool IsOpen() const { return !failed_; }
    std::string Failure() const { return isStalled_ ? "it reads nothing" : failed_.message(); }

    /// Returns false if the viewer disconnected, or read nothing for kLastSeconds after the board was closed.
    bool Send(const std::string &bytes) {
        for (size_t sent = 0; sent < bytes.size() && !failed_;) {
            bool isDone = false;
            stream_.async_write_some(boost::asio::buffer(bytes.data() + sent, bytes.size() - sent),
                                     [&](beast::error_code failed, size_t count) {
                                         failed_ = failed;
                                         sent += count;
                                         isDone = true;
                                     });
            io_.restart();
            std::optional<std::chrono::steady_clock::time_point> closed;
            while (!isDone) {
                io_.run_one_for(std::chrono::milliseconds(50));
                if (isDone || isStalled_ || !board_.IsClosed()) continue;
                if (!closed) closed = std::chrono::steady_clock::now();
                isStalled_ = SecondsSince(*closed) > kLastSeconds;
                if (isStalled_) stream_.close();  // aborts the write with an error
            }
        }
        return !failed_;
    }

  private:
    const LiveBoard &board_;
    boost::asio::io_context io_{1};
    beast::tcp_stream stream_{io_};
    beast::error_code failed_;
    bool isStalled_ = false;
};

constexpr const char *kChannels[3] = {"R", "G", "B"};

/// Sends an image in strips, one packet per channel.
bool SendImage(Connection &viewer, const LiveRender &render, const LiveImage &image) {
    const Point2i resolution = image.colors.Resolution(), low = render.pixelBounds.low;
    const int rows = std::max(1, kMaxValues / std::max(1, resolution.x));
    std::vector<float> values;
    for (int y = 0; y < resolution.y; y += rows) {
        const int height = std::min(rows, resolution.y - y);
        for (int c = 0; c < 3; ++c) {
            values.clear();
            for (int row = y; row < y + height; ++row)
                for (int x = 0; x < resolution.x; ++x) values.push_back(image.colors.Get({x, row}, c));
            Packet packet(Packet::UpdateImage);
            packet.Flag(false).Text(render.filename).Text(kChannels[c]);
            packet.Numbers({low.x, low.y + y, resolution.x, height}).Values(values);
            if (!viewer.Send(packet.Bytes())) return false;
        }
    }
    return true;
}

/// Closes an earlier render's image of the same name first, as its size may differ.
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
    const bool isNumber = !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == port.npos;
    if (!isNumber || std::stoi(port) < 1 || std::stoi(port) > 65535) return {};
    return {host, port};
}

void ShowInTev(LiveBoard &board, const std::string &server) {
    Connection viewer(board, server);
    const auto complain = [&](const char *what) {
        LogWarning("--display-server {}: {} ({}); the render continues without it.", server, what, viewer.Failure());
    };
    if (!viewer.IsOpen()) return complain("no viewer responds");
    int version = 0;
    for (;;) {
        const std::shared_ptr<const LiveImage> image = board.WaitBeyond(version, 3600);
        const bool isNew = image && image->version > version;
        if (!isNew && board.IsClosed()) return;
        if (!isNew) continue;
        const std::optional<LiveRender> render = board.Render();
        if (!render) continue;
        if (version == 0 && !SendBeginning(viewer, *render)) return complain("the viewer is gone");
        if (!SendImage(viewer, *render, *image)) return complain("the viewer is gone");
        version = image->version;
        board.ChargeThread();
        if (image->IsFinal()) return;
    }
}

}  // namespace pbrt
