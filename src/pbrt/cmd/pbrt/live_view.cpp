#include "pbrt/cmd/pbrt/live_view.h"

#include <algorithm>

#include "pbrt/core/parallel.h"

namespace pbrt {
namespace {

using Clock = std::chrono::steady_clock;

/// Estimated cost of an image before the first measurement.
constexpr double kSecondsPerPixel = 5e-8;

}  // namespace

// Remaining viewers end with the process.
LiveView::~LiveView() { WaitForViewers(0.3); }

void LiveView::SendTo(const std::string &server) {
    viewers_.emplace_back([board = board_, server] { ShowInTev(*board, server); });
}

void LiveView::Serve(int port) {
    auto page = std::make_shared<LivePage>(board_, port);
    LogInfo("Live page: {}", page->Address());
    viewers_.emplace_back([page] { page->Run(); });
}

void LiveView::Begin(const LiveRender &render) {
    board_->Describe(render);
    begin_ = Clock::now();
    spent_ = 0;
    lastCost_ = double(render.pixelBounds.Area()) * kSecondsPerPixel;
}

double LiveView::AfterWave(const Film &film, const RenderResult &result) {
    // Viewer threads take time from all render threads together.
    const double spent = spent_ + board_->Charged() / ThreadCount();
    const double due = (spent + lastCost_ - kFirstSeconds) / kMaxShare;
    const double elapsed = SecondsSince(begin_);
    if (elapsed < due) return due - elapsed;
    Take(film, LivePicture::State::Growing, result);
    lastCost_ = std::max(lastCost_ / 2, spent_ + board_->Charged() / ThreadCount() - spent);
    return std::max(0.0, (spent + 2 * lastCost_ - kFirstSeconds) / kMaxShare - elapsed);
}

void LiveView::Take(const Film &film, LivePicture::State state, const RenderResult &result) {
    const Clock::time_point start = Clock::now();
    std::optional<double> relL2;
    if (result.adaptive && result.adaptive->noise) relL2 = Sqr(*result.adaptive->noise);
    board_->Put(film.Colors(), state, result.samplesTaken, relL2);
    spent_ += SecondsSince(start);
}

void LiveView::Finish(const Film &film, const RenderResult &result) {
    if (HasViewers() && result.samplesTaken > 0)
        Take(film, result.cancelled ? LivePicture::State::Interrupted : LivePicture::State::Finished, result);
}

void LiveView::WaitForViewers(double seconds) {
    board_->Close();
    const auto deadline =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    for (LiveViewer &viewer : viewers_) viewer.WaitUntil(deadline);
    viewers_.clear();
}

}  // namespace pbrt
