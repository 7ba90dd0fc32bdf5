#include "pbrt/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace pbrt {
namespace {

TEST(ParallelFor, VisitsEveryIndexOnce) {
    for (int threads : {1, 4}) {
        ThreadLimit limit(threads);
        for (int64_t count : {0, 1, 7, 10000}) {
            std::vector<std::atomic<int>> visits(count);
            ParallelFor(count, 16, [&](int64_t begin, int64_t end) {
                for (int64_t i = begin; i < end; ++i) ++visits[i];
            });
            ParallelForEach(count, [&](int64_t i) { ++visits[i]; });
            for (const auto &v : visits) ASSERT_EQ(v, 2);
        }
    }
}

TEST(ParallelFor, ThreadIndexStaysBelowThreadCount) {
    ThreadLimit limit(3);
    EXPECT_EQ(ThreadCount(), 3);
    std::atomic<bool> inside{true};
    ParallelForEach(1000, [&](int64_t) {
        int i = ThreadIndex();
        if (i < 0 || i >= 3) inside = false;
    });
    EXPECT_TRUE(inside);
}

TEST(ParallelFor, ExceptionsReachTheCaller) {
    EXPECT_THROW(ParallelForEach(100,
                                 [](int64_t i) {
                                     if (i == 50) throw std::runtime_error("x");
                                 }),
                 std::runtime_error);
    EXPECT_THROW(ParallelFor(100, 1, [](int64_t, int64_t) { throw std::runtime_error("x"); }), std::runtime_error);
    EXPECT_THROW(ParallelInvoke([] { throw std::runtime_error("x"); }, [] {}), std::runtime_error);
}

TEST(ParallelInvoke, RunsBoth) {
    int a = 0, b = 0;
    ParallelInvoke([&] { a = 1; }, [&] { b = 2; });
    EXPECT_EQ(a + b, 3);
}

}  // namespace
}  // namespace pbrt
