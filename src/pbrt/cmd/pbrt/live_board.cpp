#include "pbrt/cmd/pbrt/live_board.h"

#include <chrono>
#include <ctime>

namespace pbrt {

void LiveBoard::Show(const std::string &phase, double fraction, double elapsed, double remaining) {
    Locked([&] { status_ = {phase, fraction, elapsed, remaining}; });
    if (next_) next_->Show(phase, fraction, elapsed, remaining);
}

void LiveBoard::PhaseDone(const std::string &phase, double elapsed) {
    Locked([&] { status_ = {phase, 1, elapsed, 0}; });
    if (next_) next_->PhaseDone(phase, elapsed);
}

void LiveBoard::Put(Image colors, LivePicture::State state, int samples) {
    Locked([&] {
        const int version = latest_ ? latest_->version + 1 : 1;
        latest_ = std::make_shared<const LivePicture>(LivePicture{std::move(colors), state, samples, version});
    });
    changed_.notify_all();
}

void LiveBoard::Close() {
    Locked([&] { isClosed_ = true; });
    changed_.notify_all();
}

std::shared_ptr<const LivePicture> LiveBoard::WaitBeyond(int version, double seconds) const {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                      [&] { return isClosed_ || (latest_ && latest_->version > version); });
    return latest_;
}

double ThreadCpuSeconds() {
    timespec t = {};
    return clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t) == 0
               ? static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec)
               : 0;
}

}  // namespace pbrt
