#include "pbrt/math/rng.h"

#include <gtest/gtest.h>

#include <set>

#include "support/statistics.h"

namespace pbrt {
namespace {

TEST(Rng, FirstNumbersAreThoseOfThePublishedPcg32) {
    // The numbers of the demonstration program of the PCG library: initial state 42, stream 54.
    Rng rng(54, 42);
    for (uint32_t expected : {0xa15c02b7u, 0x7b47f409u, 0xba1d3330u, 0x83d2f293u, 0xbfa4784bu, 0xcbed606eu})
        EXPECT_EQ(rng.Next(), expected);
}

TEST(Rng, AdvanceSkips) {
    for (uint64_t n : {0ull, 1ull, 2ull, 7ull, 1000ull, 65536ull}) {
        Rng a(9), b(9);
        for (uint64_t i = 0; i < n; ++i) a.Next();
        b.Advance(n);
        for (int i = 0; i < 4; ++i) EXPECT_EQ(a.Next(), b.Next()) << n;
    }
}

TEST(Rng, SixteenNumbersAtOnceAreTheNextOnes) {
    for (uint64_t sequence = 0; sequence < 50; ++sequence) {
        Rng rng(sequence);
        const FloatLanes all = rng.NextUniforms();
        for (int i = 0; i < Lanes32Count; ++i) EXPECT_EQ(all[i], rng.Uniform()) << sequence << " " << i;
    }
}

TEST(Rng, StreamsDiffer) {
    std::set<uint32_t> first;
    for (uint64_t s = 0; s < 1000; ++s) first.insert(Rng(s).Next());
    EXPECT_GE(first.size(), 999u);
}

TEST(Rng, UniformIsUniformAndBelowOne) {
    constexpr int kCells = 128, kDraws = 200000;
    Rng rng(11);
    std::vector<double> observed(kCells, 0), pairs(kCells, 0), integers(7, 0);
    for (int i = 0; i < kDraws; ++i) {
        Float u = rng.Uniform();
        ASSERT_GE(u, 0);
        ASSERT_LT(u, 1);
        ++observed[size_t(u * kCells)];
        Point2 p = rng.Uniform2();
        ++pairs[size_t(p.x * 16) * 8 + size_t(p.y * 8)];
        ++integers[rng.UniformInt(7)];
    }
    std::vector<double> expected(kCells, double(kDraws) / kCells), seventh(7, double(kDraws) / 7);
    double alpha = test::SidakAlpha(1e-3, 3);
    EXPECT_GT(test::ChiSquareTest(observed, expected), alpha);
    EXPECT_GT(test::ChiSquareTest(pairs, expected), alpha);
    EXPECT_GT(test::ChiSquareTest(integers, seventh), alpha);
}

TEST(Roulette, KeepsTheMeanAndNoNumberIsUsedWherePathsGoOn) {
    Rng rng(8);
    constexpr int kPaths = 100000;
    double sum = 0;
    int ended = 0;
    for (int i = 0; i < kPaths; ++i) {
        Float throughput = 3;
        if (EndsByRoulette(Float(0.25), rng, throughput)) ++ended;
        else sum += double(throughput);
    }
    EXPECT_NEAR(ended / double(kPaths), 0.75, 0.01);
    EXPECT_NEAR(sum / kPaths, 3, 0.1);
    Rng next = rng;
    Float throughput = 3;
    EXPECT_FALSE(EndsByRoulette(1, rng, throughput));
    EXPECT_EQ(throughput, 3);
    EXPECT_EQ(rng.Next(), next.Next());
}

TEST(Hash, DependsOnEveryArgumentAndTheirOrder) {
    std::set<uint64_t> seen;
    int n = 0;
    for (int a = 0; a < 30; ++a)
        for (int b = 0; b < 30; ++b) {
            seen.insert(Hash(a, b));
            seen.insert(Hash(a, b, 0));
            seen.insert(Hash(Point3(Float(a), 0, Float(b))));
            n += 3;
        }
    seen.insert(Hash(0));
    EXPECT_EQ(seen.size(), size_t(n + 1));
}

TEST(Hash, EveryInputBitFlipsHalfOfTheOutput) {
    for (int bit = 0; bit < 32; ++bit) {
        int flips = 0;
        for (uint32_t i = 0; i < 256; ++i) flips += std::popcount(Hash(i * 977, 5) ^ Hash((i * 977) ^ (1u << bit), 5));
        EXPECT_NEAR(flips / 256.0, 32, 1.5) << bit;
    }
}

TEST(Hash, FloatsOfConsecutiveIntegersAreUniform) {
    constexpr size_t kCells = 64;
    std::vector<double> observed(kCells, 0), expected(kCells, 100000.0 / kCells);
    for (int i = 0; i < 100000; ++i) {
        Float u = HashFloat(i, 3);
        ASSERT_LT(u, 1);
        ++observed[size_t(u * kCells)];
    }
    EXPECT_GT(test::ChiSquareTest(observed, expected), 1e-4);
    EXPECT_LT(HashToFloat(~0ull), 1);
    EXPECT_EQ(HashToFloat(0), 0);
}

}  // namespace
}  // namespace pbrt
