#pragma once
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>

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

/// A render before its first picture.
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

    void Describe(const LiveRender &render) {
        Locked([&] { render_ = render; });
    }
    void Put(Image colors, LivePicture::State state, int samples);
    /// Ends the viewers.
    void Close();

    Status Progress() const {
        return Locked([&] { return status_; });
    }
    std::optional<LiveRender> Render() const {
        return Locked([&] { return render_; });
    }
    /// Null before the first one.
    std::shared_ptr<const LivePicture> Latest() const {
        return Locked([&] { return latest_; });
    }
    /// Waits until there is a picture of a later version, or Close was called, or the time is over.
    std::shared_ptr<const LivePicture> WaitBeyond(int version, double seconds) const;
    bool IsClosed() const {
        return Locked([&] { return isClosed_; });
    }

    /// CPU seconds that viewers have used.
    void Charge(double cpuSeconds) {
        Locked([&] { charged_ += cpuSeconds; });
    }
    double Charged() const {
        return Locked([&] { return charged_; });
    }

  private:
    template <class F>
    std::invoke_result_t<F> Locked(F &&f) const {
        const std::lock_guard lock(mutex_);
        return f();
    }
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

/// Estimates the error of a picture that grows, without a reference, from what its last samples changed.
///
/// M1 is the mean of a pixel's first n1 samples, M2 that of n2 > n1 samples. If samples are independent with variance
/// v, then M2 - M1 has the variance v (1/n1 - 1/n2), and M2 the variance v/n2, that is (M2 - M1)^2 n1 / (n2 - n1) on
/// average. The mean of that over pixels and channels, each divided by M2^2 + RelL2Epsilon, estimates the relL2 that
/// imgtool diff measures. Samples of a low-discrepancy sampler are spread better than independent ones: they change
/// less, but what they will still change is less, too.
class ErrorEstimate {
  public:
    /// To be called for the pictures in order; some may be left out.
    void Add(std::shared_ptr<const LivePicture> picture);
    /// relL2 of the last picture; empty while there is nothing to compare with.
    std::optional<double> RelL2() const { return relL2_; }
    /// Returns why there is no estimate, for the user; empty if there is one. `isFinal`: no picture follows.
    std::string WhyNone(bool isFinal) const;

  private:
    std::shared_ptr<const LivePicture> base_, last_;
    std::optional<double> relL2_;
};

}  // namespace pbrt
