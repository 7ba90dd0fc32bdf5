// Collective operations, with threads as processes.
#include <set>

#include "pbrt/core/work_distributor.h"
#include "support/errors.h"
#include "support/team_on_threads.h"
#include "support/wait.h"

namespace pbrt {
namespace {

using test::WaitUntil;
using test::WithTeam;

TEST(Team, BroadcastsFromRank0AndReducesToIt) {
    for (int size = 1; size <= 9; ++size)
        WithTeam(size, [&](Team &team) {
            EXPECT_EQ(team.TotalThreads(), size + size / 2);
            StateWriter out;
            if (team.IsRank0()) out(std::string("to all"));
            const std::string bytes = team.Broadcast(out);
            EXPECT_EQ(StateReader(bytes, "test").Text(), "to all");
            std::multiset<int> seen = {team.Rank()};
            team.Reduce(
                [&](StateWriter &w) {
                    w.Value(uint64_t{seen.size()});
                    for (const int rank : seen) w.Value(rank);
                },
                [&](StateReader &in) {
                    std::vector<int> theirs;
                    in(theirs);
                    seen.insert(theirs.begin(), theirs.end());
                });
            if (!team.IsRank0()) return;
            EXPECT_EQ(seen.size(), size_t(size));
            for (int r = 0; r < size; ++r) EXPECT_EQ(seen.count(r), 1u);
        });
}

TEST(Team, EveryNumberIsDistributedOnce) {
    for (int size : {1, 2, 3, 5})
        for (int64_t count : {0, 1, 7, 1000}) {
            std::mutex mutex;
            std::multiset<int64_t> taken;
            std::set<int> takers;
            WithTeam(size, [&](Team &team) {
                Progress progress;
                WorkDistributor distributor(team, count, 2, progress);
                const auto haveAllTaken = [&] {
                    std::lock_guard lock(mutex);
                    return takers.size() == size_t(size);
                };
                const auto work = [&] {
                    for (bool isFirst = true; const auto i = distributor.Take(); isFirst = false) {
                        distributor.Report(1);
                        {
                            std::lock_guard lock(mutex);
                            taken.insert(*i);
                            takers.insert(team.Rank());
                        }
                        // No thread takes a second number before every process has one.
                        if (isFirst && count == 1000) {
                            EXPECT_TRUE(WaitUntil(haveAllTaken)) << "a process got nothing";
                        }
                    }
                };
                std::thread other(work);
                work();
                other.join();
                EXPECT_GE(distributor.Finish(), 0);
                EXPECT_FALSE(distributor.Take());
                EXPECT_FALSE(progress.Cancelled());
            });
            EXPECT_EQ(taken.size(), size_t(count));
            for (int64_t i = 0; i < count; ++i) EXPECT_EQ(taken.count(i), 1u);
        }
}

TEST(Team, ACancelledProcessCancelsAll) {
    for (int canceller : {0, 2}) {
        std::atomic<int64_t> taken = 0;
        std::atomic<bool> isCancelled = false;
        WithTeam(3, [&](Team &team) {
            Progress progress;
            WorkDistributor distributor(team, 1000000, 1, progress);
            for (int i = 0; distributor.Take(); ++i) {
                taken.fetch_add(1);
                if (i != 10) continue;
                if (team.Rank() == canceller) {
                    progress.Cancel();
                    isCancelled = true;
                } else {
                    // A request cancels rank 0; the reply to one cancels the others.
                    EXPECT_TRUE(WaitUntil([&] { return team.IsRank0() ? progress.Cancelled() : isCancelled.load(); }));
                }
            }
            distributor.Finish();
            EXPECT_TRUE(progress.Cancelled()) << team.Rank();
        });
        EXPECT_LT(taken, 100000);
    }
}

TEST(Team, FailuresAreReportedOnce) {
    const auto outcome = [](int size, const std::function<std::string(int)> &errorOf) {
        std::string first;
        std::atomic<int> others = 0;
        ::testing::internal::CaptureStderr();
        WithTeam(size, [&](Team &team) {
            team.Meet();
            try {
                const std::string text = errorOf(team.Rank());
                if (!text.empty()) throw UserError(text);
                team.Meet();
            } catch (const AnotherRankFailed &) {
                EXPECT_FALSE(team.IsRank0());
                ++others;
            } catch (const UserError &e) {
                team.Fail(e);
                if (team.IsRank0()) first = FormatAll(e);
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
    test::ExpectWords(both, {"Error: another\n", "1 of 3 processes (the first is 1 on "});
}

TEST(Team, AProcessAloneNeitherSendsNorMeets) {
    Team &alone = Team::Alone();
    EXPECT_EQ(alone.Size(), 1);
    EXPECT_TRUE(alone.IsRank0());
    EXPECT_EQ(alone.BroadcastValue(7), 7);
    const auto unexpected = [](auto &) { FAIL() << "there is no other process"; };
    alone.Reduce(unexpected, unexpected);
    alone.AllReduce(unexpected, unexpected);
    alone.Meet();
    alone.Fail(UserError("its own error"));
    alone.Abort(1);
    EXPECT_EQ(alone.BytesSent(), 0u);
    std::atomic<int64_t> sum = 0;
    Progress progress;
    EXPECT_EQ(DistributeWork(alone, 100, progress, [&](int64_t i) { return sum += i, int64_t{1}; }), 0);
    EXPECT_EQ(sum, 4950);
}

TEST(Team, AllReduceBringsAllRecordsToAll) {
    for (const int size : {1, 2, 5})
        WithTeam(size, [&](Team &team) {
            int records = 1 + team.Rank();
            team.AllReduce([&](StateWriter &out) { out.Value(std::exchange(records, 0)); },
                           [&](StateReader &in) { records += in.Value<int>(); });
            // Ranks above 0 have given theirs away, and get the sum.
            EXPECT_EQ(records, size * (size + 1) / 2);
        });
}

}  // namespace
}  // namespace pbrt
