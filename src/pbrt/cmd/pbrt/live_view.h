#pragma once
#include <fmt/format.h>

#include <chrono>
#include <exception>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "pbrt/cmd/pbrt/live_board.h"
#include "pbrt/core/log.h"
#include "pbrt/films/film.h"

namespace pbrt {

/// A thread that shows what a LiveBoard holds. It may outlive this object (a look-up of a host name cannot be ended),
/// so it owns all that it uses.
class LiveViewer {
  public:
    template <class Body>
    explicit LiveViewer(Body body) : hasEnded_(std::make_shared<Flag>()) {
        thread_ = std::thread([body = std::move(body), ended = hasEnded_]() mutable {
            // A failed viewer does not end the render.
            try {
                body();
            } catch (const std::exception &e) {
                LogWarning(fmt::format("a viewer of the render has ended: {}", e.what()));
            }
            const std::lock_guard lock(ended->mutex);
            ended->isSet = true;
            ended->changed.notify_all();
        });
    }
    LiveViewer(LiveViewer &&) = default;
    ~LiveViewer() {
        if (thread_.joinable()) thread_.detach();
    }
    /// Waits for the end of the thread, but no longer than until then.
    void WaitUntil(std::chrono::steady_clock::time_point deadline) {
        {
            std::unique_lock lock(hasEnded_->mutex);
            if (!hasEnded_->changed.wait_until(lock, deadline, [&] { return hasEnded_->isSet; })) return;
        }
        thread_.join();
    }

  private:
    struct Flag {
        std::mutex mutex;
        std::condition_variable changed;
        bool isSet = false;
    };
    std::shared_ptr<Flag> hasEnded_;
    std::thread thread_;
};

/// A page for browsers on this machine (127.0.0.1 only): the picture as it grows, an estimate of its error, time left.
///
///   /         the page
///   /status   what is known of the render, as JSON
///   /picture  the pixels of the last picture: red, green and blue of each as little-endian floats, row by row
class LivePage {
  public:
    /// `port` -1: kDefaultPort, or any free one if that is in use; 0: any free one. Throws UserError if the port is in
    /// use.
    LivePage(std::shared_ptr<LiveBoard> board, int port);
    ~LivePage();

    /// "http://127.0.0.1:PORT/".
    std::string Address() const;
    /// Answers browsers until the board is closed and the last picture was fetched by those that watch. To be run by a
    /// thread of its own.
    void Run();

    static constexpr int kDefaultPort = 8642;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Sends every picture of the board to a viewer that speaks the protocol of tev (https://github.com/Tom94/tev), until
/// the board is closed and the last picture is sent, or the viewer is gone. `server`: "host:port". To be run by a
/// thread of its own.
void ShowInTev(LiveBoard &board, const std::string &server);

/// Returns host and port of "host:port"; an IPv6 address may stand in brackets. Empty strings if it is something else.
std::pair<std::string, std::string> SplitServer(const std::string &server);

/// The viewers of a render, and when they get a new picture: between waves, as often as kMaxShare allows, counting what
/// the picture costs the render and the CPU time of the viewers' threads.
class LiveView {
  public:
    /// The share of the time of a render that viewers may take: a quarter of one per cent. Waiting at the ends of waves
    /// costs about as much.
    static constexpr double kMaxShare = 0.0025;
    /// Seconds that they may take besides, so that the first picture comes soon.
    static constexpr double kFirstSeconds = 0.01;
    /// The longest time after the end of a render for which viewers may keep the program from ending.
    static constexpr double kFarewellSeconds = 2;

    /// `progress`: the sink that progress is passed on to, or null.
    explicit LiveView(ProgressSink *progress) : board_(std::make_shared<LiveBoard>(progress)) {}
    ~LiveView();

    ProgressSink *Sink() { return board_.get(); }
    /// Sends the picture to a program that speaks tev's protocol; "host:port".
    void SendTo(const std::string &server);
    /// Opens the page. `port` -1: a free one. Throws UserError if the port is in use.
    void Serve(int port);
    bool HasViewers() const { return !viewers_.empty(); }

    /// When the scene is built and rendering begins.
    void Begin(const LiveRender &render);
    /// Between waves: takes a picture if one is due. Returns the seconds until the next will be.
    double AfterWave(const Film &film, int samples);
    /// The last picture; viewers get it while the file is written.
    void Finish(const Film &film, int samples, bool isInterrupted);
    /// Gives viewers time to show it, kFarewellSeconds at most.
    void SayFarewell();

  private:
    void Take(const Film &film, LivePicture::State state, int samples);
    void WaitForViewers(double seconds);
    std::shared_ptr<LiveBoard> board_;
    std::vector<LiveViewer> viewers_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    double spent_ = 0, lastCost_ = 0;  ///< seconds of the render
};

}  // namespace pbrt
