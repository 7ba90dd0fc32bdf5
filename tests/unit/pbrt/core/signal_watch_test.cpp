#include "pbrt/core/signal_watch.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "pbrt/core/files.h"

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

void WaitForCancel(const Progress &progress) {
    while (!progress.Cancelled()) std::this_thread::sleep_for(milliseconds(1));
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
    EXPECT_EXIT(Watched([](SignalWatch &watch, Progress &progress) {
                    watch.Cancel("saving", "never said", SignalWatch::kForever);
                    kill(getpid(), SIGTERM);
                    WaitForCancel(progress);
                    std::this_thread::sleep_for(milliseconds(500));
                    _exit(watch.Status() == 143 ? 5 : 6);
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
        Watched([&](SignalWatch &watch, Progress &) {
            watch.Cancel("saving", "again", SignalWatch::kForever);
            kill(getpid(), SIGINT);
            std::this_thread::sleep_for(between);
            kill(getpid(), SIGTERM);
            std::this_thread::sleep_for(milliseconds(1500));
            // Of two signals that wait at the same time, threads may take either first.
            _exit(watch.Status() == 130 || watch.Status() == 143 ? 5 : 6);
        });
    };
    EXPECT_EXIT(twice(milliseconds(0)), ExitedWithCode(5), "^saving\n$");
    EXPECT_EXIT(twice(SignalWatch::kRepeat + milliseconds(200)), ExitedWithCode(130), "^saving\nagain\n$");
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
    EXPECT_EXIT(
        {
            std::signal(SIGHUP, SIG_IGN);
            Progress progress;
            SignalWatch watch(progress, "");
            kill(getpid(), SIGHUP);
            std::this_thread::sleep_for(milliseconds(300));
            _exit(watch.Status() == 0 && !progress.Cancelled() ? 5 : 6);
        },
        ExitedWithCode(5), "");
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
