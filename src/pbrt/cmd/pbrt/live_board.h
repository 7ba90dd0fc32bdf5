#pragma once
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>

#include "pbrt/core/progress.h"
#include "pbrt/images/image.h"

namespace pbrt {

/// The picture after some samples of every pixel.
struct LivePicture {
    Image colors;  ///< R, G, B, linear, in float precision, over the rendered pixels
    enum class State { Growing, Finished, Interrupted };
    State state = State::Growing;
    int samples = 0;
    int version = 0;  ///< 1, 2, ...
    bool IsFinal() const { return state != State::Growing; }
};

/// What is known of a render before its first picture.
struct LiveRender {
    std::string scene, filename;
    Point2i fullResolution{};
    Bounds2i pixelBounds{};
    int samples = 0;        ///< to be taken of every pixel; 0: as many as there is time for
    double timeBudget = 0;  ///< seconds; 0: none
};

/// Where the render leaves what viewers show: each viewer has a thread of its own, which reads from here. All members
/// may be called from any thread. Progress is passed on to another sink, if there is one.
class LiveBoard final : public ProgressSink {
  public:
    struct Status {
        std::string phase;
        double fraction = 0, elapsed = 0, remaining = -1;  ///< seconds; remaining < 0: not known
    };
    explicit LiveBoard(ProgressSink *next) : next_(next) {}

    void Show(const std::string &phase, double fraction, double elapsed, double remaining) override;
    void PhaseDone(const std::string &phase, double elapsed) override;

    void Describe(const LiveRender &render);
    void Put(Image colors, LivePicture::State state, int samples);
    /// Tells the viewers to end, because there will be no more.
    void Close();

    Status Progress() const;
    std::optional<LiveRender> Render() const;
    /// Null before the first one.
    std::shared_ptr<const LivePicture> Latest() const;
    /// Waits until there is a picture of a later version, or Close was called, or the time is over.
    std::shared_ptr<const LivePicture> WaitBeyond(int version, double seconds) const;
    bool IsClosed() const;

    /// CPU seconds that viewers have used.
    void Charge(double cpuSeconds);
    double Charged() const;

  private:
    ProgressSink *next_;
    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    Status status_;
    std::optional<LiveRender> render_;
    std::shared_ptr<const LivePicture> latest_;
    double charged_ = 0;
    bool isClosed_ = false;
};

inline double SecondsSince(std::chrono::steady_clock::time_point t) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
}
/// CPU seconds of the calling thread.
double ThreadCpuSeconds();

}  // namespace pbrt
