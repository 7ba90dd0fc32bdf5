#include "pbrt/cmd/pbrt/live_board.h"

#include <chrono>
#include <ctime>

namespace pbrt {

void LiveBoard::Show(const std::string &phase, double fraction, double elapsed, double remaining) {
    {
        const std::lock_guard lock(mutex_);
        status_ = {phase, fraction, elapsed, remaining};
    }
    if (next_) next_->Show(phase, fraction, elapsed, remaining);
}

void LiveBoard::PhaseDone(const std::string &phase, double elapsed) {
    {
        const std::lock_guard lock(mutex_);
        status_ = {phase, 1, elapsed, 0};
    }
    if (next_) next_->PhaseDone(phase, elapsed);
}

void LiveBoard::Describe(const LiveRender &render) {
    const std::lock_guard lock(mutex_);
    render_ = render;
}

void LiveBoard::Put(Image colors, LivePicture::State state, int samples) {
    {
        const std::lock_guard lock(mutex_);
        const int version = latest_ ? latest_->version + 1 : 1;
        latest_ = std::make_shared<const LivePicture>(LivePicture{std::move(colors), state, samples, version});
    }
    changed_.notify_all();
}

void LiveBoard::Close() {
    {
        const std::lock_guard lock(mutex_);
        isClosed_ = true;
    }
    changed_.notify_all();
}

LiveBoard::Status LiveBoard::Progress() const {
    const std::lock_guard lock(mutex_);
    return status_;
}

std::optional<LiveRender> LiveBoard::Render() const {
    const std::lock_guard lock(mutex_);
    return render_;
}

std::shared_ptr<const LivePicture> LiveBoard::Latest() const {
    const std::lock_guard lock(mutex_);
    return latest_;
}

std::shared_ptr<const LivePicture> LiveBoard::WaitBeyond(int version, double seconds) const {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                      [&] { return isClosed_ || (latest_ && latest_->version > version); });
    return latest_;
}

bool LiveBoard::IsClosed() const {
    const std::lock_guard lock(mutex_);
    return isClosed_;
}

void LiveBoard::Charge(double cpuSeconds) {
    const std::lock_guard lock(mutex_);
    charged_ += cpuSeconds;
}

double LiveBoard::Charged() const {
    const std::lock_guard lock(mutex_);
    return charged_;
}

double ThreadCpuSeconds() {
    timespec t = {};
    return clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t) == 0
               ? static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec)
               : 0;
}

}  // namespace pbrt
