#include "pbrt/math/sobol.h"

#include <gtest/gtest.h>

#include <boost/random/sobol.hpp>
#include <set>

#include "support/sampling.h"
#include "support/statistics.h"

namespace pbrt {
namespace {

TEST(Sobol, AllDimensionsAgreeWithBoost) {
    // Boost walks in Gray-code order and leaves out the origin.
    boost::random::sobol_engine<uint64_t, 64u> engine(SobolDimensions);
    const uint32_t *m = SobolMatrices();
    for (uint64_t i = 1; i < 300; ++i)
        for (int d = 0; d < SobolDimensions; ++d)
            ASSERT_EQ(SobolBits(m + d * SobolIndexBits, i ^ (i >> 1)), uint32_t(engine() >> 32)) << i << " " << d;
}

TEST(Sobol, HighIndicesAgreeWithBoost) {
    boost::random::sobol_engine<uint64_t, 64u> engine(64);
    const uint32_t *m = SobolMatrices();
    for (int bit = 2; bit < 51; ++bit) {
        uint64_t start = (uint64_t(1) << bit) + 5;
        engine.seed();
        engine.discard((start - 1) * 64);
        for (int d = 0; d < 64; ++d)
            ASSERT_EQ(SobolBits(m + d * SobolIndexBits, start ^ (start >> 1)), uint32_t(engine() >> 32))
                << bit << " " << d;
    }
}

TEST(Sobol, TablesAndShortcutsEqualTheMatrices) {
    const uint32_t *m = SobolMatrices();
    Rng rng(2);
    for (int i = 0; i < 20000; ++i) {
        uint64_t index = (uint64_t(rng.Next()) << 32 | rng.Next()) >> (12 + rng.UniformInt(50));
        auto d = size_t(rng.UniformInt(SobolDimensions));
        ASSERT_EQ(SobolBitsByTable(SobolTables() + d, index), SobolBits(m + d * SobolIndexBits, index))
            << d << " " << index;
        ASSERT_EQ(ReverseBits(SobolReversed0(index)), SobolBits(m, index)) << index;
        ASSERT_EQ(ReverseBits(SobolReversed1(index)), SobolBits(m + SobolIndexBits, index)) << index;
    }
}

TEST(Scramble, LanesAgreeWithSingleNumbers) {
    Rng rng(4);
    for (int i = 0; i < 2000; ++i) {
        Lanes64 v, seed;
        Lanes32 bits, low, high;
        for (int lane = 0; lane < Lanes64Count; ++lane) {
            v[lane] = rng.Next();
            seed[lane] = uint64_t(rng.Next()) << 32 | rng.Next();
        }
        for (int lane = 0; lane < Lanes32Count; ++lane) {
            bits[lane] = rng.Next();
            low[lane] = rng.Next();
            high[lane] = rng.Next();
        }
        const Lanes64 owen = OwenScramble(v, seed);
        for (int lane = 0; lane < Lanes64Count; ++lane)
            ASSERT_EQ(owen[lane], OwenScramble(uint32_t(v[lane]), uint64_t(seed[lane])));
        const Lanes32 fast = FastOwenScrambleReversed(bits, low, high), reversed = ReverseBits(bits);
        const FloatLanes floats = FractionsToFloat(bits);
        for (int lane = 0; lane < Lanes32Count; ++lane) {
            const uint32_t b = bits[lane];
            ASSERT_EQ(fast[lane], FastOwenScrambleReversed(b, uint64_t(high[lane]) << 32 | low[lane]));
            ASSERT_EQ(reversed[lane], ReverseBits(b));
            ASSERT_EQ(floats[lane], SobolToFloat(b));
        }
    }
    EXPECT_EQ(FractionsToFloat(Lanes32{} + 0xffffffffu)[3], OneMinusEpsilon);
}

uint32_t FastOwenScramble(uint32_t v, uint64_t seed) {
    return ReverseBits(FastOwenScrambleReversed(ReverseBits(v), seed));
}

using Scramble = uint32_t (*)(uint32_t, uint64_t);
const std::pair<const char *, Scramble> kScrambles[] = {{"owen", OwenScramble}, {"fastowen", FastOwenScramble}};

TEST(Scramble, DigitsDependOnEarlierDigitsOnly) {
    Rng rng(2);
    for (auto [name, scramble] : kScrambles)
        for (int i = 0; i < 2000; ++i) {
            uint32_t v = rng.Next();
            uint64_t seed = uint64_t(rng.Next()) << 32 | rng.Next();
            int keep = int(rng.UniformInt(32)) + 1;  // number of common leading digits
            uint32_t mask = keep == 32 ? 0 : ~0u >> keep, other = (v & ~mask) | (rng.Next() & mask);
            uint32_t a = scramble(v, seed), b = scramble(other, seed);
            ASSERT_EQ((a ^ b) & ~mask, 0u) << name;
            if (v != other) {
                // The first digit that differs before scrambling differs after it as well, so distinct numbers stay
                // distinct.
                ASSERT_EQ(std::countl_zero(v ^ other), std::countl_zero(a ^ b)) << name;
            }
        }
}

TEST(Scramble, FlipsOfSiblingsAreIndependent) {
    // Each of the eight nodes of the third level flips independently, so all 2^8 patterns of flips are equally likely.
    constexpr int kSeeds = 1 << 16;
    std::vector<double> expected(256, kSeeds / 256.0);
    for (auto [name, scramble] : kScrambles) {
        std::vector<double> observed(256, 0);
        for (uint64_t s = 0; s < kSeeds; ++s) {
            unsigned pattern = 0;
            for (uint32_t node = 0; node < 8; ++node) pattern |= (scramble(node << 29, MixBits(s)) >> 28 & 1) << node;
            ++observed[pattern];
        }
        if (std::string(name) == "owen") {
            EXPECT_GT(test::ChiSquareTest(observed, expected), 1e-4) << name;
        } else {
            // A hash of a few operations cannot give all patterns equally often; but pairs must be independent.
            for (int a = 0; a < 8; ++a)
                for (int b = 0; b < a; ++b) {
                    double cells[4] = {};
                    for (unsigned p = 0; p < 256; ++p) cells[(p >> a & 1) * 2 + (p >> b & 1)] += observed[p];
                    for (double c : cells) EXPECT_NEAR(c / kSeeds, 0.25, 0.02) << a << " " << b;
                }
        }
    }
}

TEST(Scramble, DeepDigitsFlipHalfTheTimeInDistantBranches) {
    constexpr int kSeeds = 20000;
    Rng rng(3);
    for (auto [name, scramble] : kScrambles)
        for (int digit : {0, 1, 2, 5, 9, 15, 23, 31})
            for (int t = 0; t < 4; ++t) {
                uint32_t v = rng.Next(), w = digit == 0 ? v : rng.Next();
                int flips = 0, equal = 0;
                for (uint64_t s = 0; s < kSeeds; ++s) {
                    uint32_t fv = (scramble(v, MixBits(s)) ^ v) >> (31 - digit) & 1;
                    uint32_t fw = (scramble(w, MixBits(s)) ^ w) >> (31 - digit) & 1;
                    flips += int(fv);
                    equal += fv == fw;
                }
                EXPECT_NEAR(flips / double(kSeeds), 0.5, 0.025) << name << " " << digit;
                if (digit > 0 && (v ^ w) >> (32 - digit) != 0) {
                    EXPECT_NEAR(equal / double(kSeeds), 0.5, 0.025) << name << " " << digit;
                }
            }
}

TEST(Scramble, NetsStayNets) {
    for (int k : {0, 1, 4, 7, 10})
        for (uint64_t first : {uint64_t(0), uint64_t(5) << k}) {
            std::vector<std::pair<uint32_t, uint32_t>> plain, owen, fast;
            for (uint64_t i = first; i < first + (uint64_t(1) << k); ++i) {
                uint32_t x = ReverseBits(SobolReversed0(i)), y = ReverseBits(SobolReversed1(i));
                plain.push_back({x, y});
                owen.push_back({OwenScramble(x, 11), OwenScramble(y, 12)});
                fast.push_back({FastOwenScramble(x, MixBits(11)), FastOwenScramble(y, MixBits(12))});
            }
            EXPECT_TRUE(test::IsNet(plain));
            EXPECT_TRUE(test::IsNet(owen));
            EXPECT_TRUE(test::IsNet(fast));
        }
}

TEST(SobolPixelIndex, PointsLieInTheirPixelAndNoneIsMissing) {
    const uint32_t *m = SobolMatrices();
    for (int log2 : {0, 1, 2, 3, 5}) {
        SobolPixelIndex find(log2);
        uint32_t n = 1u << log2;
        std::set<uint64_t> indices;
        for (uint64_t frame = 0; frame < 6; ++frame)
            for (uint32_t y = 0; y < n; ++y)
                for (uint32_t x = 0; x < n; ++x) {
                    uint64_t i = find(frame, x, y);
                    indices.insert(i);
                    ASSERT_EQ(uint64_t(SobolBits(m, i)) >> (32 - log2), x) << log2 << " " << frame;
                    ASSERT_EQ(uint64_t(SobolBits(m + SobolIndexBits, i)) >> (32 - log2), y) << log2 << " " << frame;
                }
        EXPECT_EQ(indices.size(), 6u * n * n);
        EXPECT_EQ(*indices.rbegin(), 6u * n * n - 1);
    }
    SobolPixelIndex big(12);
    for (uint64_t frame : {uint64_t(0), uint64_t(1) << 20, (uint64_t(1) << 28) - 1}) {
        uint64_t i = big(frame, 4095, 1234);
        EXPECT_EQ(SobolBits(m, i) >> 20, 4095u);
        EXPECT_EQ(SobolBits(m + SobolIndexBits, i) >> 20, 1234u);
    }
    SobolPixelIndex widest(20);
    const uint64_t last = widest(4095, (1u << 20) - 1, 77777);
    EXPECT_EQ(SobolBits(m, last) >> 12, (1u << 20) - 1);
    EXPECT_EQ(SobolBits(m + SobolIndexBits, last) >> 12, 77777u);
    EXPECT_EQ(widest(4096 + 5, 3, 4), widest(5, 3, 4));
}

}  // namespace
}  // namespace pbrt
