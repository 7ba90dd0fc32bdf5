#include "pbrt/core/progress.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "support/test_clock.h"

namespace pbrt {
namespace {

using std::chrono::milliseconds;

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
};

TEST(Progress, ShowsFractionsOfThePhaseNotTooOften) {
    RecordingSink sink;
    test::TestClock clock;
    Progress progress(&sink, std::ref(clock));
    progress.BeginPhase("building", 1000);
    for (int i = 0; i < 99; ++i) progress.Advance();
    EXPECT_TRUE(sink.shown.empty()) << "a very short phase must show nothing";
    clock.Advance(milliseconds(100));
    progress.Advance();
    for (int i = 0; i < 399; ++i) progress.Advance();
    ASSERT_EQ(sink.shown.size(), 1u);
    EXPECT_EQ(sink.shown[0].phase, "building");
    EXPECT_NEAR(sink.shown[0].fraction, 0.1, 1e-9);
    EXPECT_NEAR(sink.shown[0].remaining, 0.9, 1e-9);
    clock.Advance(milliseconds(199));
    progress.Advance();
    EXPECT_EQ(sink.shown.size(), 1u);
    clock.Advance(milliseconds(1));
    progress.Advance(0);
    ASSERT_EQ(sink.shown.size(), 2u);
    EXPECT_NEAR(sink.shown[1].fraction, 0.5, 1e-9);
    EXPECT_NEAR(progress.EndPhase(), 0.3, 1e-9);
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
    test::TestClock clock;
    Progress progress(&sink, std::ref(clock));
    progress.BeginPhase("preparing", 0);
    clock.Advance(milliseconds(40));
    progress.BeginPhase("prepass", 10);
    clock.Advance(milliseconds(5));
    progress.BeginPhase("tiles", 10);
    clock.Advance(milliseconds(10));
    EXPECT_NEAR(progress.EndPhase(), 0.01, 1e-9);
    EXPECT_NEAR(progress.EndPhase(), 0.015, 1e-9);
    progress.SetTotal(100);
    progress.Advance(50);
    progress.Advance(25);
    EXPECT_TRUE(sink.shown.empty());
    clock.Advance(milliseconds(100));
    progress.Advance(0);
    ASSERT_EQ(sink.shown.size(), 1u);
    EXPECT_EQ(sink.shown[0].phase, "preparing");
    EXPECT_NEAR(sink.shown[0].fraction, 0.75, 1e-9) << "all work of the phase so far counts";
    EXPECT_NEAR(progress.EndPhase(), 0.155, 1e-9);
    EXPECT_EQ(sink.done, (std::vector<std::string>{"    tiles", "  prepass", "preparing"}));
    progress.BeginPhase("rendering", 10);
    EXPECT_EQ(progress.EndPhase(), 0);
    EXPECT_EQ(sink.done.back(), "rendering");
}

TEST(Progress, QuietHasNoSink) { EXPECT_EQ(MakeTerminalProgress(true), nullptr); }

}  // namespace
}  // namespace pbrt
