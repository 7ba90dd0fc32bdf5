// What processes do together, here as threads.
#include <set>

#include "pbrt/core/hand_out.h"
#include "support/errors.h"
#include "support/ranks_on_threads.h"

namespace pbrt {
namespace {

using test::WithRanks;

TEST(Ranks, EverybodyGetsTheFirstsBytesAndTheFirstEverybodys) {
    for (int size = 1; size <= 9; ++size)
        WithRanks(size, [&](Ranks &ranks) {
            EXPECT_EQ(ranks.TotalThreads(), size + size / 2);
            StateWriter out;
            if (ranks.IsFirst()) out.Text("to all");
            const std::string bytes = ranks.Broadcast(out);
            EXPECT_EQ(StateReader(bytes, "test").Text(), "to all");
            std::multiset<int> seen = {ranks.Rank()};
            ranks.Reduce([&](StateWriter &w) { w.CopyOfVector(std::vector<int>(seen.begin(), seen.end())); },
                         [&](StateReader &in) {
                             std::vector<int> theirs;
                             in.Vector(&theirs);
                             seen.insert(theirs.begin(), theirs.end());
                         });
            if (!ranks.IsFirst()) return;
            EXPECT_EQ(seen.size(), static_cast<size_t>(size));
            for (int r = 0; r < size; ++r) EXPECT_EQ(seen.count(r), 1u);
        });
}

TEST(Ranks, EveryNumberIsHandedOutOnce) {
    for (int size : {1, 2, 3, 5})
        for (int64_t count : {0, 1, 7, 1000}) {
            std::mutex mutex;
            std::multiset<int64_t> taken;
            std::set<int> takers;
            WithRanks(size, [&](Ranks &ranks) {
                Progress progress;
                HandOut handOut(ranks, count, 2, progress);
                int64_t reported = 0;
                const auto work = [&] {
                    while (const auto i = handOut.Take()) {
                        std::this_thread::sleep_for(std::chrono::microseconds(20));
                        handOut.Report(1);
                        std::lock_guard lock(mutex);
                        taken.insert(*i);
                        takers.insert(ranks.Rank());
                    }
                };
                std::thread other(work);
                work();
                other.join();
                reported = handOut.Finish();
                EXPECT_GE(reported, 0);
                EXPECT_FALSE(handOut.Take());
                EXPECT_FALSE(progress.Cancelled());
            });
            EXPECT_EQ(taken.size(), static_cast<size_t>(count));
            for (int64_t i = 0; i < count; ++i) EXPECT_EQ(taken.count(i), 1u);
            if (count == 1000) {
                EXPECT_EQ(takers.size(), static_cast<size_t>(size)) << "somebody got nothing";
            }
        }
}

TEST(Ranks, WhoeverIsCancelledCancelsAll) {
    for (int canceller : {0, 2}) {
        std::atomic<int64_t> taken = 0;
        WithRanks(3, [&](Ranks &ranks) {
            Progress progress;
            HandOut handOut(ranks, 1000000, 1, progress);
            for (int i = 0; handOut.Take(); ++i) {
                taken.fetch_add(1);
                std::this_thread::sleep_for(std::chrono::microseconds(20));
                if (i == 10 && ranks.Rank() == canceller) progress.Cancel();
            }
            handOut.Finish();
            EXPECT_TRUE(progress.Cancelled()) << ranks.Rank();
        });
        EXPECT_LT(taken, 100000);
    }
}

TEST(Ranks, FailuresAreToldOnce) {
    const auto outcome = [](int size, const std::function<std::string(int)> &errorOf) {
        std::string first;
        std::atomic<int> others = 0;
        ::testing::internal::CaptureStderr();
        WithRanks(size, [&](Ranks &ranks) {
            ranks.Meet();
            try {
                const std::string text = errorOf(ranks.Rank());
                if (!text.empty()) throw UserError(text);
                ranks.Meet();
            } catch (const AnotherRankFailed &) {
                EXPECT_FALSE(ranks.IsFirst());
                ++others;
            } catch (const UserError &e) {
                ranks.Fail(e);
                if (ranks.IsFirst()) first = FormatAll(e);
                else ++others;
            }
        });
        EXPECT_EQ(others, first.empty() ? 0 : size - 1);
        return first + ::testing::internal::GetCapturedStderr();
    };
    EXPECT_EQ(outcome(4, [](int) { return ""; }), "");
    EXPECT_EQ(outcome(4, [](int) { return "bad scene"; }), "Error: bad scene\n");
    const std::string two = outcome(5, [](int r) { return r > 2 ? "no such file" : ""; });
    test::ExpectWords(two, {"2 of 5 processes (the first is 3 on "});
    EXPECT_EQ(two.find("no such file"), two.rfind("no such file")) << two;
    const std::string both = outcome(3, [](int r) { return r == 1 ? "one" : "another"; });
    test::ExpectWords(both, {"Error: another\n"});
    test::ExpectWords(both, {"1 of 3 processes (the first is 1 on "});
}

}  // namespace
}  // namespace pbrt
