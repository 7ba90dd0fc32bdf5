#include "pbrt/core/counters.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace pbrt {
namespace {

TEST(Counters, SumOverThreadsThatAreGoneToo) {
    ResetCounters();
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([] {
            for (int i = 0; i < 1000; ++i) ++ThreadCounters().shadowRays;
            ThreadCounters().pathVertices += 5;
        });
    for (std::thread &t : threads) t.join();
    ++ThreadCounters().cameraPaths;
    EXPECT_EQ(SumCounters().shadowRays, 4000u);
    EXPECT_EQ(SumCounters().pathVertices, 20u);
    EXPECT_EQ(SumCounters().cameraPaths, 1u);
    ResetCounters();
    EXPECT_EQ(SumCounters().shadowRays, 0u);
}

}  // namespace
}  // namespace pbrt
