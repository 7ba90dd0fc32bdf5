#pragma once
#include <cmath>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "pbrt/core/progress.h"
#include "pbrt/images/metrics.h"

namespace pbrt {

struct LiveImage {
    Image colors;  ///< R, G, B, linear, float, over the rendered pixels
    enum class State { Growing, Finished, Interrupted };
    State state = State::Growing;
    int samples = 0;
    int version = 0;                ///< 1, 2, ...
    std::optional<double> relL2{};  ///< as estimated by an adaptive render
    bool IsFinal() const { return state != State::Growing; }
};

/// Render properties available before the first image.
struct LiveRender {
    std::string scene, filename;
    Point2i fullResolution{};
    Bounds2i pixelBounds{};
    int samples = 0;        ///< per pixel; 0: limited by time
    double timeBudget = 0;  ///< seconds; 0: none
};

/// Data shared between the render and its viewers, each of which reads in its own thread. Thread-safe. Forwards
/// progress to another sink, if any.
class LiveBoard final : public ProgressSink {
  public:
    struct Status {
        std::string phase;
        double fraction = 0, elapsed = 0, remaining = -1;  ///< seconds; remaining < 0: unknown
    };
    explicit LiveBoard(ProgressSink *next) : next_(next) {}

    void Show(const std::string &phase, double fraction, double elapsed, double remaining) override {
        Assign(status_, Status{phase, fraction, elapsed, remaining});
        if (next_) next_->Show(phase, fraction, elapsed, remaining);
    }
    void PhaseDone(const std::string &phase, double elapsed) override {
        Assign(status_, Status{phase, 1, elapsed, 0});
        if (next_) next_->PhaseDone(phase, elapsed);
    }

    void Describe(const LiveRender &render) { Assign(render_, render); }
    void Put(Image colors, LiveImage::State state, int samples, std::optional<double> relL2 = {}) {
        const std::lock_guard lock(mutex_);
        const int version = latest_ ? latest_->version + 1 : 1;
        latest_ = std::make_shared<const LiveImage>(LiveImage{std::move(colors), state, samples, version, relL2});
        changed_.notify_all();
    }
    /// Terminates the viewers.
    void Close() {
        Assign(isClosed_, true);
        changed_.notify_all();
    }

    Status Progress() const { return Copy(status_); }
    std::optional<LiveRender> Render() const { return Copy(render_); }
    /// Null before the first image.
    std::shared_ptr<const LiveImage> Latest() const { return Copy(latest_); }
    /// Waits for an image of a later version, Close, or a time-out in seconds.
    std::shared_ptr<const LiveImage> WaitBeyond(int version, double seconds) const {
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                          [&] { return isClosed_ || (latest_ && latest_->version > version); });
        return latest_;
    }
    bool IsClosed() const { return Copy(isClosed_); }

    /// Adds the CPU time of the calling viewer's thread since its last call.
    void ChargeThread() {
        thread_local double charged = 0;
        const double now = ClockSeconds(CLOCK_THREAD_CPUTIME_ID);
        const std::lock_guard lock(mutex_);
        charged_ += now - std::exchange(charged, now);
    }
    /// CPU seconds of all viewers.
    double Charged() const { return Copy(charged_); }

  private:
    template <class T>
    T Copy(const T &member) const {
        const std::lock_guard lock(mutex_);
        return member;
    }
    template <class T, class U>
    void Assign(T &member, U &&value) {
        const std::lock_guard lock(mutex_);
        member = std::forward<U>(value);
    }
    ProgressSink *next_;
    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    Status status_;
    std::optional<LiveRender> render_;
    std::shared_ptr<const LiveImage> latest_;
    double charged_ = 0;
    bool isClosed_ = false;
};

/// Estimates the error of a progressive image without reference, from the change by its last samples.
///
/// M1 is the mean of a pixel's first n1 samples, M2 that of n2 > n1. For independent samples of variance v, M2 - M1 has
/// variance v (1/n1 - 1/n2) and M2 variance v/n2, which is (M2 - M1)^2 n1 / (n2 - n1) on average. Its mean over pixels
/// and channels, each divided by M2^2 + RelL2Epsilon, estimates the relL2 of imgtool diff. Low-discrepancy samples
/// change the image less than independent ones, but their remaining error is smaller, too. An adaptive render's own
/// estimate is used instead.
class ErrorEstimate {
  public:
    /// Call for the images in order; images may be skipped.
    void Add(std::shared_ptr<const LiveImage> image) {
        if (!image || image->samples < 1 || (last_ && image->samples <= last_->samples)) return;
        const double n2 = image->samples;
        // With few additional samples the estimate is rough; the previous base is better then.
        if (last_ && (!base_ || 4 * last_->samples <= 3 * image->samples)) base_ = last_;
        if (image->relL2) {
            relL2_ = image->relL2;
        } else if (base_) {
            const double n1 = base_->samples;
            relL2_ = ImageError(base_->colors, image->colors, Metric::RelL2) * n1 / (n2 - n1);
        }
        last_ = std::move(image);
    }
    /// relL2 of the last image; empty without an earlier one to compare.
    std::optional<double> RelL2() const { return relL2_; }
    /// Why there is no estimate, for the user; empty if there is one. `isFinal`: no image follows.
    std::string WhyNone(bool isFinal) const {
        if (!last_) return isFinal ? "no image was made" : "no samples yet";
        if (!relL2_)
            return isFinal ? "an estimate needs two images; the render had only one"
                           : "an estimate needs two images; this is the first";
        return std::isfinite(*relL2_) ? "" : "some pixels are not finite";
    }

  private:
    std::shared_ptr<const LiveImage> base_, last_;
    std::optional<double> relL2_;
};

}  // namespace pbrt
