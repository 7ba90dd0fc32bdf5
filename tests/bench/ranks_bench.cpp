// What processes pay for working together: mpirun -n N ranks_bench. Prints, as measured by rank 0, the seconds
// of a meeting of all, of a reduction and a broadcast of many bytes, and of distributing a number.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>

#include "pbrt/core/team.h"
#include "pbrt/core/work_distributor.h"

namespace {

using namespace pbrt;

/// The smallest of several measurements, because other programs may run beside.
template <class F>
double SecondsOf(int times, F &&act) {
    double smallest = 1e9;
    for (int i = 0; i < times; ++i) {
        const auto start = std::chrono::steady_clock::now();
        act();
        smallest = std::min(smallest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return smallest;
}

}  // namespace

int main() {
    const std::unique_ptr<Team> team = ConnectTeam(1);
    if (team->Size() == 1) {
        std::printf("start it with mpirun -n 2 or more\n");
        return 1;
    }
    constexpr size_t kBytes = size_t{64} << 20;
    const std::string many(kBytes, 'x');
    const double meeting = SecondsOf(2000, [&] { team->Meet(); });
    size_t sum = 0;
    const double reduction = SecondsOf(20, [&] {
        team->Reduce([&](StateWriter &out) { out.Refer(many.data(), many.size()); },
                     [&](StateReader &in) { sum += in.BytesLeft(); });
    });
    StateWriter all;
    if (team->IsRank0()) all.Refer(many.data(), many.size());
    const double broadcast = SecondsOf(20, [&] { sum += team->Broadcast(all).size(); });
    constexpr int64_t kNumbers = 100000;
    Progress progress;
    int64_t mine = 0;
    const double distribution = SecondsOf(3, [&] {
        WorkDistributor numbers(*team, kNumbers, 1, progress);
        for (mine = 0; numbers.Take(); ++mine) continue;
        numbers.Finish();
        team->Meet();
    });
    // What a reply costs rank 0: here it only replies, and its CPU time is measured.
    int64_t taken = 0;
    const std::clock_t before = std::clock();
    {
        WorkDistributor numbers(*team, kNumbers / 10, 1, progress);
        if (!team->IsRank0())
            while (numbers.Take()) ++taken;
        numbers.Finish();
    }
    const double answering = double(std::clock() - before) / CLOCKS_PER_SEC;
    if (team->IsRank0()) std::printf("a reply takes rank 0 %.1f us of CPU\n", 1e6 * answering / (kNumbers / 10 / 4));
    if (team->IsRank0())
        std::printf(
            "%d processes: meeting %.1f us; %zu MB: reduction %.3f s, broadcast %.3f s; %.0f numbers distributed a "
            "millisecond, %.0f %% to rank 0 (%zu)\n",
            team->Size(), 1e6 * meeting, kBytes >> 20, reduction, broadcast, double(kNumbers) / distribution / 1e3,
            100 * double(mine) / double(kNumbers), sum);
    return 0;
}
