#include "pbrt/cmd/pbrt/live_view.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <nlohmann/json.hpp>

#include "live_page_text.h"
#include "pbrt/core/error.h"

namespace pbrt {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

/// Seconds since its last request for which a browser counts as connected.
constexpr double kConnectedSeconds = 3;

/// State shared by the sessions; used by the page's thread only.
struct Shared {
    std::shared_ptr<LiveBoard> board;
    ErrorEstimate error;
    Clock::time_point lastRequest = Clock::now() - std::chrono::hours(1);  ///< of any browser
    bool lastIsFetched = false;                                            ///< of the final image

    std::string StatusText() {
        const LiveBoard::Status s = board->Progress();
        const std::shared_ptr<const LiveImage> image = board->Latest();
        error.Add(image);
        Json json = {{"phase", s.phase},
                     {"fraction", s.fraction},
                     {"elapsed", s.elapsed},
                     {"remaining", s.remaining >= 0 ? Json(s.remaining) : Json()},
                     {"version", image ? image->version : 0},
                     {"isFinal", image && image->IsFinal()},
                     {"isInterrupted", image && image->state == LiveImage::State::Interrupted},
                     {"samples", image ? image->samples : 0},
                     {"relL2", error.RelL2() ? Json(*error.RelL2()) : Json()},
                     {"whyNoError", error.WhyNone(image && image->IsFinal())}};
        if (const std::optional<LiveRender> render = board->Render()) {
            json["scene"] = render->scene;
            json["file"] = render->filename;
            json["width"] = render->pixelBounds.Width();
            json["height"] = render->pixelBounds.Height();
            json["samplesWanted"] = render->samples > 0 ? Json(render->samples) : Json();
            json["timeBudget"] = render->timeBudget > 0 ? Json(render->timeBudget) : Json();
        }
        return json.dump(-1, ' ', false, Json::error_handler_t::replace);
    }
};

class Session : public std::enable_shared_from_this<Session> {
  public:
    Session(tcp::socket socket, Shared &shared) : stream_(std::move(socket)), shared_(shared) {}

    void Read() {
        request_ = {};
        stream_.expires_after(std::chrono::seconds(30));
        http::async_read(stream_, buffer_, request_, [self = shared_from_this()](beast::error_code failed, size_t) {
            if (!failed) self->Respond();
        });
    }

  private:
    /// DNS rebinding: pages from elsewhere must not read the image through a host name that points here.
    bool HasLocalHost() const {
        std::string host(request_[http::field::host]);
        host = host.substr(0, host.rfind(':'));
        return host == "127.0.0.1" || host == "localhost";
    }

    void Respond() {
        shared_.lastRequest = Clock::now();
        const std::string path(request_.target());
        if (!HasLocalHost()) return SendText(http::status::forbidden, "text/plain", "This page is for localhost.\n");
        if (request_.method() != http::verb::get)
            return SendText(http::status::method_not_allowed, "text/plain", "Only GET is supported.\n");
        if (path == "/") return SendText(http::status::ok, "text/html; charset=utf-8", kLivePageText);
        if (path == "/status") return SendText(http::status::ok, "application/json", shared_.StatusText());
        if (path == "/picture")
            if (const std::shared_ptr<const LiveImage> image = shared_.board->Latest()) return SendImage(image);
        SendText(http::status::not_found, "text/plain", "There is nothing here.\n");
    }

    void SendText(http::status status, const char *type, std::string text) {
        auto response = std::make_shared<http::response<http::string_body>>(status, request_.version());
        response->set(http::field::content_type, type);
        response->body() = std::move(text);
        Send(response, [] {});
    }

    void SendImage(const std::shared_ptr<const LiveImage> &image) {
        using Body = http::span_body<const char>;
        auto response = std::make_shared<http::response<Body>>(http::status::ok, request_.version());
        response->set(http::field::content_type, "application/octet-stream");
        response->set("X-Version", std::to_string(image->version));
        response->body() = {static_cast<const char *>(image->colors.Data()),
                            image->colors.ValueCount() * sizeof(float)};
        Send(response, [image, &shared = shared_] { shared.lastIsFetched |= image->IsFinal(); });
    }

    template <class Response, class WhenSent>
    void Send(const std::shared_ptr<Response> &response, WhenSent whenSent) {
        response->set(http::field::cache_control, "no-store");
        response->keep_alive(request_.keep_alive());
        response->prepare_payload();
        http::async_write(stream_, *response,
                          [self = shared_from_this(), response, whenSent](beast::error_code failed, size_t) {
                              if (failed) return;
                              whenSent();
                              if (response->keep_alive()) return self->Read();
                              beast::error_code ignored;
                              self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                          });
    }

    beast::tcp_stream stream_;
    beast::flat_buffer buffer_{1 << 14};
    http::request<http::empty_body> request_;
    Shared &shared_;
};

}  // namespace

struct LivePage::Impl {
    Shared shared;
    asio::io_context io{1};
    tcp::acceptor acceptor{io};

    bool Open(int port) {
        const tcp::endpoint here(asio::ip::address_v4::loopback(), static_cast<unsigned short>(port));
        try {
            constexpr bool kReuseAddress = true;  // of an earlier render, at once
            acceptor = tcp::acceptor(io, here, kReuseAddress);
            return true;
        } catch (const beast::system_error &) {
            return false;
        }
    }
    void Accept() {
        acceptor.async_accept([this](beast::error_code failed, tcp::socket socket) {
            if (!failed) std::make_shared<Session>(std::move(socket), shared)->Read();
            else  // temporary, such as too many open files
                std::this_thread::sleep_for(std::chrono::milliseconds(100));
            if (acceptor.is_open()) Accept();
        });
    }
};

LivePage::LivePage(std::shared_ptr<LiveBoard> board, int port) : impl_(std::make_unique<Impl>()) {
    impl_->shared.board = std::move(board);
    const bool isOpen = port >= 0 ? impl_->Open(port) : impl_->Open(kDefaultPort) || impl_->Open(0);
    if (!isOpen)
        throw UserError("--serve: port {} of this machine is in use, or not allowed; --serve=0 takes a free one.",
                        port >= 0 ? port : kDefaultPort);
}

LivePage::~LivePage() = default;

std::string LivePage::Address() const {
    return fmt::format("http://127.0.0.1:{}/", impl_->acceptor.local_endpoint().port());
}

void LivePage::Run() {
    Shared &shared = impl_->shared;
    impl_->Accept();
    for (;;) {
        impl_->io.run_one_for(std::chrono::milliseconds(100));
        shared.board->ChargeThread();
        if (!shared.board->IsClosed()) continue;
        const std::shared_ptr<const LiveImage> image = shared.board->Latest();
        const bool awaitsLast = image && image->IsFinal() && !shared.lastIsFetched;
        if (!awaitsLast || SecondsSince(shared.lastRequest) > kConnectedSeconds) return;
    }
}

}  // namespace pbrt
