#include "pbrt/cmd/pbrt/live_board.h"

#include <cmath>
#include <ctime>

#include "pbrt/images/metrics.h"

namespace pbrt {

void LiveBoard::Show(const std::string &phase, double fraction, double elapsed, double remaining) {
    Assign(status_, Status{phase, fraction, elapsed, remaining});
    if (next_) next_->Show(phase, fraction, elapsed, remaining);
}

void LiveBoard::PhaseDone(const std::string &phase, double elapsed) {
    Assign(status_, Status{phase, 1, elapsed, 0});
    if (next_) next_->PhaseDone(phase, elapsed);
}

void LiveBoard::Put(Image colors, LivePicture::State state, int samples, std::optional<double> relL2) {
    {
        const std::lock_guard lock(mutex_);
        const int version = latest_ ? latest_->version + 1 : 1;
        latest_ = std::make_shared<const LivePicture>(LivePicture{std::move(colors), state, samples, version, relL2});
    }
    changed_.notify_all();
}

void LiveBoard::Close() {
    Assign(isClosed_, true);
    changed_.notify_all();
}

std::shared_ptr<const LivePicture> LiveBoard::WaitBeyond(int version, double seconds) const {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                      [&] { return isClosed_ || (latest_ && latest_->version > version); });
    return latest_;
}

void LiveBoard::ChargeThread() {
    thread_local double charged = 0;
    timespec t = {};
    if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t) != 0) return;
    const double now = double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
    const std::lock_guard lock(mutex_);
    charged_ += now - std::exchange(charged, now);
}

void ErrorEstimate::Add(std::shared_ptr<const LivePicture> picture) {
    if (!picture || picture->samples < 1 || (last_ && picture->samples <= last_->samples)) return;
    const double n2 = picture->samples;
    // With few additional samples the estimate is rough; the previous base is better then.
    if (last_ && (!base_ || 4 * last_->samples <= 3 * picture->samples)) base_ = last_;
    if (picture->relL2) {
        relL2_ = picture->relL2;
    } else if (base_) {
        const double n1 = base_->samples;
        relL2_ = ImageError(base_->colors, picture->colors, Metric::RelL2) * n1 / (n2 - n1);
    }
    last_ = std::move(picture);
}

std::string ErrorEstimate::WhyNone(bool isFinal) const {
    if (!last_) return isFinal ? "no picture was made" : "no samples yet";
    if (!relL2_)
        return isFinal ? "an estimate needs two pictures; the render had only one"
                       : "an estimate needs two pictures; this is the first";
    return std::isfinite(*relL2_) ? "" : "some pixels are not finite";
}

}  // namespace pbrt
