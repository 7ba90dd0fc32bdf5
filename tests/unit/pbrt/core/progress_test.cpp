#include "pbrt/core/progress.h"

#include <gtest/gtest.h>

#include <vector>

#include "support/wait.h"

namespace pbrt {
namespace {

struct RecordingSink : ProgressSink {
    struct Shown {
        std::string phase;
        double fraction, remaining;
    };
    std::vector<Shown> shown;
    std::vector<std::string> done;
    void Show(const std::string &phase, double fraction, double, double remaining) override {
        shown.push_back({phase, fraction, remaining});
    }
    void PhaseDone(const std::string &phase, double) override { done.push_back(phase); }
    /// Waits until something is shown of a phase that goes on.
    bool IsShown(Progress &progress) const {
        return test::WaitUntil([&] {
            progress.Advance(0);
            return !shown.empty();
        });
    }
};

TEST(Progress, ShowsFractionsOfThePhaseNotTooOften) {
    RecordingSink sink;
    Progress progress(&sink);
    progress.BeginPhase("building", 1000);
    for (int i = 0; i < 100; ++i) progress.Advance();
    EXPECT_TRUE(sink.shown.empty()) << "a very short phase must show nothing";
    EXPECT_TRUE(sink.IsShown(progress));
    for (int i = 0; i < 400; ++i) progress.Advance();
    ASSERT_EQ(sink.shown.size(), 1u);
    EXPECT_EQ(sink.shown[0].phase, "building");
    EXPECT_NEAR(sink.shown[0].fraction, 0.1, 1e-9);
    EXPECT_GT(sink.shown[0].remaining, 0);
    EXPECT_GT(progress.EndPhase(), 0.1);
    EXPECT_EQ(sink.done, std::vector<std::string>{"building"});
}

TEST(Progress, WorksWithoutASinkAndCancels) {
    Progress progress;
    progress.BeginPhase("x", 10);
    progress.Advance(10);
    progress.SetFraction(0.5, 1);
    EXPECT_GE(progress.EndPhase(), 0);
    EXPECT_FALSE(progress.Cancelled());
    progress.Cancel();
    EXPECT_TRUE(progress.Cancelled());
}

TEST(Progress, APhaseInsideAnotherIsAPartOfIt) {
    RecordingSink sink;
    Progress progress(&sink);
    progress.BeginPhase("preparing", 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(41));
    progress.BeginPhase("prepass", 10);
    progress.BeginPhase("tiles", 10);
    EXPECT_LT(progress.EndPhase(), 0.02);
    EXPECT_LT(progress.EndPhase(), 0.02);
    progress.SetTotal(100);
    progress.Advance(50);
    progress.Advance(25);
    EXPECT_TRUE(sink.IsShown(progress));
    ASSERT_EQ(sink.shown.size(), 1u);
    EXPECT_EQ(sink.shown[0].phase, "preparing");
    EXPECT_NEAR(sink.shown[0].fraction, 0.75, 1e-9) << "all work of the phase so far counts";
    EXPECT_GE(progress.EndPhase(), 0.14);
    EXPECT_EQ(sink.done, (std::vector<std::string>{"    tiles", "  prepass", "preparing"}));
    progress.BeginPhase("rendering", 10);
    EXPECT_LT(progress.EndPhase(), 0.02);
    EXPECT_EQ(sink.done.back(), "rendering");
}

TEST(Progress, QuietHasNoSink) { EXPECT_EQ(MakeTerminalProgress(true), nullptr); }

}  // namespace
}  // namespace pbrt
