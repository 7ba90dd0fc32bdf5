#pragma once
#include <algorithm>
#include <chrono>
#include <exception>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "pbrt/cmd/pbrt/live_board.h"
#include "pbrt/core/log.h"
#include "pbrt/core/parallel.h"
#include "pbrt/integrators/render_loop.h"

namespace pbrt {

/// Viewer thread of a LiveBoard. Owns all it uses, as it may outlive this object (in a host name look-up).
class LiveViewer {
  public:
    explicit LiveViewer(auto body) {
        std::promise<void> ended;
        hasEnded_ = ended.get_future();
        thread_ = std::thread([body = std::move(body), ended = std::move(ended)]() mutable {
            // A failed viewer does not stop the render.
            try {
                body();
            } catch (const std::exception &e) {
                LogWarning("a viewer of the render has ended: {}", e.what());
            }
            ended.set_value();
        });
    }
    LiveViewer(LiveViewer &&) = default;
    ~LiveViewer() {
        if (thread_.joinable()) thread_.detach();
    }
    /// Waits until the thread ends, or the deadline.
    void WaitUntil(std::chrono::steady_clock::time_point deadline) {
        if (hasEnded_.wait_until(deadline) == std::future_status::ready) thread_.join();
    }

  private:
    std::future<void> hasEnded_;
    std::thread thread_;
};

/// Web page on 127.0.0.1 with the progressive image, its estimated error and the remaining time.
///
///   /         the page
///   /status   state of the render, as JSON
///   /picture  pixels of the last image: R, G, B as little-endian floats, row by row
class LivePage {
  public:
    /// `port` -1: kDefaultPort, or any free one if in use; 0: any free one. Throws UserError if the port is in use.
    LivePage(std::shared_ptr<LiveBoard> board, int port);
    ~LivePage();

    std::string Address() const;
    /// Serves browsers until the board is closed and connected ones have the last image. Run in its own thread.
    void Run();

    static constexpr int kDefaultPort = 8642;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Sends every image to a viewer with tev's protocol (https://github.com/Tom94/tev), until the board is closed and the
/// last image is sent, or the viewer disconnects. `server`: "host:port". Run in its own thread.
void ShowInTev(LiveBoard &board, const std::string &server);

/// Splits "host:port"; an IPv6 address may be in brackets. Empty strings if malformed.
std::pair<std::string, std::string> SplitServer(const std::string &server);

/// Viewers of a render. Updates them between waves as often as kMaxShare allows, counting the render's cost per image
/// and the viewer threads' CPU time.
class LiveView {
  public:
    static constexpr double kMaxShare = 0.0025;    ///< of render time; waiting at wave ends costs about as much
    static constexpr double kFirstSeconds = 0.01;  ///< in addition, for an early first image
    static constexpr double kFarewellSeconds = 2;  ///< by which viewers may delay the program's exit

    /// `progress`: sink to forward progress to, or null.
    explicit LiveView(ProgressSink *progress) : board_(std::make_shared<LiveBoard>(progress)) {}
    /// Remaining viewers end with the process.
    ~LiveView() { WaitForViewers(0.3); }

    ProgressSink *Sink() { return board_.get(); }
    void SendTo(const std::string &server) {
        viewers_.emplace_back([board = board_, server] { ShowInTev(*board, server); });
    }
    /// As LivePage.
    void Serve(int port) {
        auto page = std::make_shared<LivePage>(board_, port);
        LogInfo("Live page: {}", page->Address());
        viewers_.emplace_back([page] { page->Run(); });
    }
    bool HasViewers() const { return !viewers_.empty(); }

    void Begin(const LiveRender &render) {
        board_->Describe(render);
        begin_ = Clock::now();
        spent_ = 0;
        lastCost_ = double(render.pixelBounds.Area()) * kSecondsPerPixel;
    }
    /// Call between waves: publishes an image if due. Returns the seconds until the next is due.
    double AfterWave(const Film &film, const RenderResult &result) {
        // Viewer threads take time from all render threads together.
        const double spent = spent_ + board_->Charged() / ThreadCount();
        const double due = (spent + lastCost_ - kFirstSeconds) / kMaxShare;
        const double elapsed = SecondsSince(begin_);
        if (elapsed < due) return due - elapsed;
        Take(film, LiveImage::State::Growing, result);
        lastCost_ = std::max(lastCost_ / 2, spent_ + board_->Charged() / ThreadCount() - spent);
        return std::max(0.0, (spent + 2 * lastCost_ - kFirstSeconds) / kMaxShare - elapsed);
    }
    /// Publishes the last image; viewers receive it while the file is written.
    void Finish(const Film &film, const RenderResult &result) {
        if (HasViewers() && result.samplesTaken > 0)
            Take(film, result.cancelled ? LiveImage::State::Interrupted : LiveImage::State::Finished, result);
    }
    /// Waits at most this long for viewers to show it.
    void WaitForViewers(double seconds) {
        board_->Close();
        const auto deadline =
            Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
        for (LiveViewer &viewer : viewers_) viewer.WaitUntil(deadline);
        viewers_.clear();
    }

  private:
    using Clock = std::chrono::steady_clock;
    static constexpr double kSecondsPerPixel = 5e-8;  ///< of an image, before the first measurement

    void Take(const Film &film, LiveImage::State state, const RenderResult &result) {
        const Clock::time_point start = Clock::now();
        std::optional<double> relL2;
        if (result.adaptive && result.adaptive->noise) relL2 = Sqr(*result.adaptive->noise);
        board_->Put(film.Colors(), state, result.samplesTaken, relL2);
        spent_ += SecondsSince(start);
    }
    std::shared_ptr<LiveBoard> board_;
    std::vector<LiveViewer> viewers_;
    Clock::time_point begin_ = Clock::now();
    double spent_ = 0, lastCost_ = 0;  ///< seconds of the render
};

}  // namespace pbrt
