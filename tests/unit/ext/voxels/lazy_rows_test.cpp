#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "ext/voxels/voxel_light_sampler.h"

namespace {

using namespace ext;

TEST(LazyRows, ARowIsMadeOnceAndKept) {
    LazyRows<int> rows;
    rows.Reset(5, 3);
    int calls = 0;
    auto get = [&](size_t row) {
        return rows.Get(row, [&](std::span<int> v) {
            ++calls;
            for (int &x : v) x = int(row) * 10;
        });
    };
    EXPECT_EQ(rows.Filled(), 0u);
    std::span<const int> first = get(2);
    ASSERT_EQ(first.size(), 3u);
    EXPECT_EQ(first[2], 20);
    EXPECT_EQ(get(2).data(), first.data());
    EXPECT_EQ(calls, 1);
    EXPECT_EQ(rows.Filled(), 1u);
    EXPECT_EQ(get(0)[0], 0);
    EXPECT_EQ(rows.Filled(), 2u);
    rows.Reset(5, 3);
    EXPECT_EQ(rows.Filled(), 0u);
}

TEST(LazyRows, ThreadsThatMeetAtARowAllGetTheSameArray) {
    const size_t count = 200, length = 1000;
    LazyRows<uint32_t> rows;
    rows.Reset(count, length);
    const int threads = 8;
    std::atomic<int> ready{0};
    std::vector<std::vector<const uint32_t *>> seen(threads, std::vector<const uint32_t *>(count));
    std::atomic<bool> right{true};
    std::vector<std::thread> pool;
    for (int t = 0; t < threads; ++t)
        pool.emplace_back([&, t] {
            ++ready;
            while (ready < threads) std::this_thread::yield();
            for (size_t r = 0; r < count; ++r) {
                std::span<const uint32_t> row = rows.Get(r, [&](std::span<uint32_t> v) {
                    for (size_t i = 0; i < v.size(); ++i) v[i] = uint32_t(r * length + i);
                });
                seen[size_t(t)][r] = row.data();
                for (size_t i = 0; i < length; ++i)
                    if (row[i] != r * length + i) right = false;
            }
        });
    for (std::thread &t : pool) t.join();
    EXPECT_TRUE(right);
    for (const auto &s : seen) EXPECT_EQ(s, seen[0]);
    EXPECT_EQ(rows.Filled(), count);
}

}  // namespace
