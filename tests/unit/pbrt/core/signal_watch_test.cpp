#include "pbrt/core/signal_watch.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "pbrt/core/files.h"
#include "support/test_clock.h"
#include "support/wait.h"

namespace pbrt {
namespace {

using std::chrono::milliseconds;

/// Ends the child process of a test after 20 seconds, with a status that no test expects.
[[noreturn]] void Hang() {
    std::this_thread::sleep_for(std::chrono::seconds(20));
    _exit(77);
}

/// Runs `act` under a watch, then waits; for a child process.
[[noreturn]] void Watched(const std::function<void(SignalWatch &, Progress &)> &act,
                          const std::string &message = "at once") {
    Progress progress;
    SignalWatch watch(progress, message);
    act(watch, progress);
    Hang();
}

/// Runs `act` under a watch with this clock until all signals that `act` raised are handled, and ends with status 5;
/// for a child process.
[[noreturn]] void WatchedToTheEnd(const std::function<Progress::Clock::time_point()> &now,
                                  const std::function<void(SignalWatch &, Progress &)> &act) {
    Progress progress(nullptr, now);
    {
        SignalWatch watch(progress, "at once");
        act(watch, progress);
    }
    _exit(5);
}

void WaitForCancel(const Progress &progress) {
    if (!test::WaitUntil([&] { return progress.Cancelled(); })) _exit(77);
}

/// Every test runs its code in a separate process.
class SignalWatchTest : public ::testing::Test {
  protected:
    void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

using ::testing::ExitedWithCode;

TEST_F(SignalWatchTest, EndsAtOnceWhereNothingIsToBeSaved) {
    for (int signal : {SIGINT, SIGTERM, SIGHUP})
        EXPECT_EXIT(Watched([&](SignalWatch &, Progress &) { kill(getpid(), signal); }, "Interrupted while reading"),
                    ExitedWithCode(128 + signal), "Interrupted while reading");
}

TEST_F(SignalWatchTest, LetsWorkEndThatPollsProgress) {
    // Of this clock, a day passes between any two readings.
    const auto days = [day = 0]() mutable { return Progress::Clock::time_point(std::chrono::hours(24 * ++day)); };
    EXPECT_EXIT(WatchedToTheEnd(days,
                                [](SignalWatch &watch, Progress &progress) {
                                    watch.Cancel("saving", "not printed", SignalWatch::kForever);
                                    kill(getpid(), SIGTERM);
                                    WaitForCancel(progress);
                                    if (watch.Status() != 143) _exit(6);
                                }),
                ExitedWithCode(5), "^saving\n$");
}

TEST_F(SignalWatchTest, GivesWorkNoMoreThanItsTime) {
    EXPECT_EXIT(Watched([](SignalWatch &watch, Progress &) {
                    watch.Cancel("finishing", "stopped", 0.1);
                    kill(getpid(), SIGINT);
                }),
                ExitedWithCode(130), "^finishing\nstopped\n$");
}

TEST_F(SignalWatchTest, ASignalHoldsForTheNextPhase) {
    EXPECT_EXIT(Watched([](SignalWatch &watch, Progress &progress) {
                    watch.Cancel("", "first", SignalWatch::kForever);
                    kill(getpid(), SIGHUP);
                    WaitForCancel(progress);
                    watch.EndAtOnce("second");
                }),
                ExitedWithCode(129), "^second\n$");
}

TEST_F(SignalWatchTest, ASecondSignalEndsAtOnceButNotARepeatedOne) {
    auto twice = [](milliseconds between) {
        test::TestClock clock;
        WatchedToTheEnd(std::ref(clock), [&](SignalWatch &watch, Progress &progress) {
            watch.Cancel("saving", "again", SignalWatch::kForever);
            raise(SIGINT);
            WaitForCancel(progress);
            clock.Advance(between);
            raise(SIGTERM);
            if (watch.Status() != 130) _exit(6);
        });
    };
    EXPECT_EXIT(twice(SignalWatch::kRepeat - milliseconds(1)), ExitedWithCode(5), "^saving\n$");
    EXPECT_EXIT(twice(SignalWatch::kRepeat), ExitedWithCode(130), "^saving\nagain\n$");
}

TEST_F(SignalWatchTest, RemovesTemporariesAndNothingElse) {
    const std::filesystem::path top = std::filesystem::path(::testing::TempDir()) / "signal_watch_test";
    std::filesystem::remove_all(top);
    std::filesystem::create_directories(top / "folder/inside");
    for (const char *name : {"half", "whole", "folder/inside/tiles"}) std::ofstream(top / name) << "x";
    EXPECT_EXIT(Watched([&](SignalWatch &, Progress &) {
                    const Temporary half((top / "half").string()), folder((top / "folder").string());
                    { const Temporary done((top / "whole").string()); }
                    kill(getpid(), SIGTERM);
                    Hang();
                }),
                ExitedWithCode(143), "");
    EXPECT_FALSE(std::filesystem::exists(top / "half"));
    EXPECT_FALSE(std::filesystem::exists(top / "folder"));
    EXPECT_TRUE(std::filesystem::exists(top / "whole"));
    std::filesystem::remove_all(top);
}

TEST_F(SignalWatchTest, HangUpStaysIgnoredUnderNohup) {
    // The status is that of the first signal which is not ignored; a thread takes its own signals in order.
    EXPECT_EXIT(
        {
            std::signal(SIGHUP, SIG_IGN);
            Watched([](SignalWatch &, Progress &) {
                raise(SIGHUP);
                raise(SIGTERM);
            });
        },
        ExitedWithCode(143), "");
}

TEST_F(SignalWatchTest, AClosedPipeForTheMessageDelaysNothing) {
    EXPECT_EXIT(Watched([](SignalWatch &watch, Progress &) {
                    int ends[2];
                    if (pipe(ends) != 0) _exit(6);
                    close(ends[0]);
                    dup2(ends[1], STDERR_FILENO);
                    watch.Cancel("not printed", "not printed", 0.1);
                    kill(getpid(), SIGTERM);
                }),
                ExitedWithCode(143), "");
}

TEST_F(SignalWatchTest, AfterwardsSignalsDoWhatTheyDidBefore) {
    EXPECT_EXIT(
        {
            {
                Progress progress;
                SignalWatch watch(progress, "");
            }
            kill(getpid(), SIGTERM);
            Hang();
        },
        ::testing::KilledBySignal(SIGTERM), "");
}

}  // namespace
}  // namespace pbrt
