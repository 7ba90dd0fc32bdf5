// What processes pay for working together: mpirun -n N ranks_bench. Prints, as the first process sees it, the seconds
// of a meeting of all, of a reduction and a broadcast of many bytes, and of handing out a number.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>

#include "pbrt/core/hand_out.h"
#include "pbrt/core/ranks.h"

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
    const std::unique_ptr<Ranks> ranks = ConnectRanks(1);
    if (!ranks) {
        std::printf("start it with mpirun -n 2 or more\n");
        return 1;
    }
    constexpr size_t kBytes = size_t{64} << 20;
    const std::string many(kBytes, 'x');
    const double meeting = SecondsOf(2000, [&] { ranks->Meet(); });
    size_t sum = 0;
    const double reduction = SecondsOf(20, [&] {
        ranks->Reduce([&](StateWriter &out) { out.Refer(many.data(), many.size()); },
                      [&](StateReader &in) { sum += in.BytesLeft(); });
    });
    StateWriter all;
    if (ranks->IsFirst()) all.Refer(many.data(), many.size());
    const double broadcast = SecondsOf(20, [&] { sum += ranks->Broadcast(all).size(); });
    constexpr int64_t kNumbers = 100000;
    Progress progress;
    int64_t mine = 0;
    const double handOut = SecondsOf(3, [&] {
        HandOut numbers(*ranks, kNumbers, 1, progress);
        for (mine = 0; numbers.Take(); ++mine) continue;
        numbers.Finish();
        ranks->Meet();
    });
    // What an answer costs the first process: here it only answers, and its CPU time is measured.
    int64_t asked = 0;
    const std::clock_t before = std::clock();
    {
        HandOut numbers(*ranks, kNumbers / 10, 1, progress);
        if (!ranks->IsFirst())
            while (numbers.Take()) ++asked;
        numbers.Finish();
    }
    const double answering = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
    if (ranks->IsFirst())
        std::printf("an answer takes the first process %.1f us of CPU\n", 1e6 * answering / (kNumbers / 10 / 4));
    if (ranks->IsFirst())
        std::printf(
            "%d processes: meeting %.1f us; %zu MB: reduction %.3f s, broadcast %.3f s; %.0f numbers handed out a "
            "millisecond, %.0f %% to the first (%zu)\n",
            ranks->Size(), 1e6 * meeting, kBytes >> 20, reduction, broadcast,
            static_cast<double>(kNumbers) / handOut / 1e3,
            100 * static_cast<double>(mine) / static_cast<double>(kNumbers), sum);
    return 0;
}
