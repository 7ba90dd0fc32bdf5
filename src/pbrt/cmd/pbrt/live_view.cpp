#include "pbrt/cmd/pbrt/live_view.h"

#include <algorithm>

#include "pbrt/cmd/pbrt/live_page.h"
#include "pbrt/cmd/pbrt/tev_display.h"
#include "pbrt/core/log.h"
#include "pbrt/core/parallel.h"

namespace pbrt {

namespace {

using Clock = std::chrono::steady_clock;
double SecondsSince(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

/// What a picture may cost before the first one has told.
constexpr double kSecondsPerPixel = 1e-7;

}  // namespace

LiveView::~LiveView() { board_->Close(); }

void LiveView::SendTo(const std::string &server) {
    viewers_.emplace_back([board = board_, server] { ShowInTev(*board, server); });
}

void LiveView::Serve(int port) {
    auto page = std::make_shared<LivePage>(board_, port);
    LogInfo(fmt::format("Live page: {}", page->Address()));
    viewers_.emplace_back([page] { page->Run(); });
}

void LiveView::Begin(const LiveRender &render) {
    board_->Describe(render);
    begin_ = Clock::now();
    spent_ = 0;
    lastCost_ = static_cast<double>(render.pixelBounds.Area()) * kSecondsPerPixel;
}

double LiveView::AfterWave(const Film &film, int samples) {
    // The viewers' threads take time from all threads of the render together.
    const double spent = spent_ + board_->Charged() / ThreadCount();
    const double due = (spent + lastCost_) / kMaxShare;
    const double elapsed = SecondsSince(begin_);
    if (elapsed < due) return due - elapsed;
    Take(film, samples, false);
    lastCost_ = std::max(lastCost_ / 2, spent_ + board_->Charged() / ThreadCount() - spent);
    return std::max(0.0, (spent + 2 * lastCost_) / kMaxShare - elapsed);
}

void LiveView::Take(const Film &film, int samples, bool isFinal) {
    const Clock::time_point start = Clock::now();
    board_->Put(film.Colors(), samples, isFinal);
    spent_ += SecondsSince(start);
}

void LiveView::Finish(const Film &film, int samples) {
    if (HasViewers()) Take(film, samples, true);
}

void LiveView::SayFarewell() {
    board_->Close();
    const auto deadline =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(kFarewellSeconds));
    for (LiveViewer &viewer : viewers_) viewer.WaitUntil(deadline);
    viewers_.clear();
}

}  // namespace pbrt
