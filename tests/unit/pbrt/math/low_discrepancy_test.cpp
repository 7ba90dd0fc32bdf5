#include "pbrt/math/low_discrepancy.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "support/sampling.h"
#include "support/statistics.h"

namespace pbrt {
namespace {

TEST(Bits, ReverseAndMortonMatchTheSlowWay) {
    Rng rng(1);
    for (int i = 0; i < 1000; ++i) {
        uint32_t x = rng.Next(), y = rng.Next(), reversed = 0;
        uint64_t morton = 0;
        for (int b = 0; b < 32; ++b) {
            reversed |= (x >> b & 1) << (31 - b);
            morton |= uint64_t(x >> b & 1) << (2 * b) | uint64_t(y >> b & 1) << (2 * b + 1);
        }
        ASSERT_EQ(ReverseBits(x), reversed);
        ASSERT_EQ(EncodeMorton2(x, y), morton);
    }
}

TEST(PermutationElement, IsAPermutation) {
    for (uint32_t n = 1; n <= 300; ++n)
        for (uint64_t seed : {0ull, 1ull, 0x123456789abcdefull}) {
            std::vector<bool> hit(n, false);
            for (uint32_t i = 0; i < n; ++i) {
                uint32_t j = PermutationElement(i, n, seed);
                ASSERT_LT(j, n);
                ASSERT_FALSE(hit[j]) << n << " " << seed;
                hit[j] = true;
            }
        }
}

TEST(PermutationElement, EveryElementGoesEverywhereEquallyOften) {
    constexpr int kSeeds = 40000;
    for (uint32_t n : {2u, 3u, 4u, 5u, 16u, 23u, 100u})
        for (uint32_t i : {0u, 1u, n - 1}) {
            std::vector<double> observed(n, 0), expected(n, double(kSeeds) / n);
            for (uint64_t s = 0; s < kSeeds; ++s) ++observed[PermutationElement(i, n, s)];
            EXPECT_GT(test::ChiSquareTest(observed, expected), test::SidakAlpha(1e-3, 21)) << n << " " << i;
        }
}

TEST(PermutationElement, PairsGoToAllPairs) {
    // A keyed hash is not an ideal random permutation, but no pair may be missing or come much too often.
    constexpr int kSeeds = 100000;
    for (uint32_t n : {4u, 5u, 16u, 17u}) {
        std::vector<int> count(n * n, 0);
        for (uint64_t s = 0; s < kSeeds; ++s)
            ++count[PermutationElement(0, n, MixBits(s)) * n + PermutationElement(1, n, MixBits(s))];
        double expected = double(kSeeds) / (n * (n - 1));
        for (uint32_t a = 0; a < n; ++a)
            for (uint32_t b = 0; b < n; ++b)
                if (a != b) {
                    EXPECT_NEAR(count[a * n + b] / expected, 1, 0.2) << n << ": " << a << " " << b;
                }
    }
}

TEST(PermutationElement, LanesAgreeWithSingleNumbers) {
    Rng rng(6);
    for (uint32_t n : {1u, 2u, 3u, 4u, 11u, 16u, 64u, 100u, 1024u})
        for (int i = 0; i < 100; ++i) {
            Lanes64 seed;
            for (int lane = 0; lane < Lanes64Count; ++lane) seed[lane] = uint64_t(rng.Next()) << 32 | rng.Next();
            const uint32_t element = rng.UniformInt(n);
            const Lanes64 places = PermutationElementOf(element, n, seed);
            for (int lane = 0; lane < Lanes64Count; ++lane)
                ASSERT_EQ(places[lane], PermutationElement(element, n, uint64_t(seed[lane]))) << n;
        }
}

TEST(PlaceInQuad, AllOrdersOccurEquallyOften) {
    constexpr int kCount = 24 * 400;
    std::map<std::vector<uint64_t>, int> orders;
    for (int i = 0; i < kCount; ++i) {
        const Lanes64 hash = Lanes64{} + (uint64_t(0x100000000) * uint64_t(i)) / kCount;
        std::vector<uint64_t> order;
        for (uint64_t element = 0; element < 4; ++element) order.push_back(PlaceInQuad(element, hash)[3]);
        ++orders[order];
        std::sort(order.begin(), order.end());
        ASSERT_EQ(order, (std::vector<uint64_t>{0, 1, 2, 3}));
    }
    EXPECT_EQ(orders.size(), 24u);
    for (const auto &[order, count] : orders) EXPECT_NEAR(count, 400, 1);
}

TEST(Primes, AreTheFirstThousand) {
    EXPECT_EQ(Primes[0], 2);
    EXPECT_EQ(Primes[1], 3);
    EXPECT_EQ(Primes[24], 97);
    EXPECT_EQ(Primes[999], 7919);
    for (size_t i = 1; i < Primes.size(); ++i) EXPECT_GT(Primes[i], Primes[i - 1]);
}

TEST(RadicalInverse, MirrorsDigits) {
    EXPECT_EQ(RadicalInverse(2, 0), 0);
    EXPECT_EQ(RadicalInverse(2, 1), 0.5f);
    EXPECT_EQ(RadicalInverse(2, 6), 0.375f);
    EXPECT_FLOAT_EQ(RadicalInverse(3, 5), 2.f / 3 + 1.f / 9);
    EXPECT_FLOAT_EQ(RadicalInverse(10, 1234), 0.4321f);
    EXPECT_LT(RadicalInverse(2, ~0ull), 1);
    EXPECT_LT(RadicalInverse(7919, ~0ull), 1);
}

TEST(RadicalInverse, InverseUndoes) {
    for (auto [base, digits, count] : {std::tuple{2u, 7, 128u}, {3u, 5, 243u}, {10u, 3, 1000u}})
        for (uint64_t a = 0; a < count; ++a) {
            auto mirrored = uint64_t(std::lround(double(RadicalInverse(base, a)) * count));
            EXPECT_EQ(InverseRadicalInverse(mirrored, base, digits), a);
        }
}

/// True if base^k consecutive values lie in different intervals of length base^-k.
template <class F>
bool IsStratified(uint32_t base, int k, uint64_t first, const F &value) {
    auto n = uint64_t(std::lround(std::pow(double(base), k)));
    std::set<int64_t> cells;
    for (uint64_t i = 0; i < n; ++i) cells.insert(int64_t(double(value(first + i)) * double(n) + 1e-4));
    return cells.size() == n;
}

using Scrambling = Float (*)(uint32_t base, uint64_t a, uint64_t seed);
const std::pair<const char *, Scrambling> kScramblings[] = {
    {"permuted", PermutedRadicalInverse},
    {"Owen", OwenScrambledRadicalInverse},
    {"affine, half",
     [](uint32_t base, uint64_t a, uint64_t seed) { return test::AffineRadicalInverse(base, a, base / 2, seed); }},
    {"affine, last",
     [](uint32_t base, uint64_t a, uint64_t seed) { return test::AffineRadicalInverse(base, a, base - 1, seed); }}};

TEST(RadicalInverse, ScramblingsKeepTheStratification) {
    for (uint32_t base : {2u, 3u, 5u, 11u, 31u})
        for (int k : {1, 2}) {
            auto n = uint64_t(std::lround(std::pow(double(base), k)));
            EXPECT_TRUE(IsStratified(base, k, 3 * n, [&](uint64_t a) { return RadicalInverse(base, a); }));
            for (uint64_t seed : {0ull, 77ull})
                for (auto [name, scrambled] : kScramblings)
                    EXPECT_TRUE(IsStratified(base, k, 3 * n,
                                             [&, inverse = scrambled](uint64_t a) { return inverse(base, a, seed); }))
                        << name << " " << base;
        }
}

TEST(RadicalInverse, ScrambledPointsAreUniformOverSeeds) {
    constexpr int kSeeds = 20000, kCells = 50;
    const std::vector<double> expected(kCells, double(kSeeds) / kCells);
    for (uint32_t base : {2u, 5u, 7u, 101u})
        for (uint64_t a : {0ull, 1ull, 12345678ull})
            for (auto [name, scrambled] : kScramblings) {
                std::vector<double> observed(kCells, 0);
                for (uint64_t s = 0; s < kSeeds; ++s) {
                    const Float u = scrambled(base, a, MixBits(s));
                    ASSERT_TRUE(u >= 0 && u < 1);
                    ++observed[size_t(u * kCells)];
                }
                EXPECT_GT(test::ChiSquareTest(observed, expected), test::SidakAlpha(1e-3, 48))
                    << name << " " << base << " " << a;
            }
}

TEST(RadicalInverse, OwenChoosesTheSecondDigitByTheFirst) {
    // Compares the permutations of the second digit below two different first digits: they are equal for digit
    // permutations and independent for Owen scrambling.
    int permutedEqual = 0, owenEqual = 0;
    for (uint64_t seed = 0; seed < 200; ++seed) {
        auto second = [&](auto f, uint64_t first, uint64_t digit) {
            return int(f(5, first + 5 * digit, seed) * 25) % 5;
        };
        permutedEqual += second(PermutedRadicalInverse, 0, 2) == second(PermutedRadicalInverse, 1, 2);
        owenEqual += second(OwenScrambledRadicalInverse, 0, 2) == second(OwenScrambledRadicalInverse, 1, 2);
    }
    EXPECT_EQ(permutedEqual, 200);
    EXPECT_NEAR(owenEqual, 40, 25);
}

TEST(DigitPermutations, LanesEqualTheSlowTwin) {
    std::vector<uint32_t> multipliers(40);
    for (size_t d = 0; d < multipliers.size(); ++d) multipliers[d] = 1 + uint32_t(Hash(d) % (Primes[d] - 1));
    const DigitPermutations tables(multipliers, 5);
    Rng rng(3);
    for (size_t first = 0; first < multipliers.size(); ++first)
        for (int i = 0; i < 200; ++i) {
            const uint64_t a = i < 5 ? uint64_t(i) : uint64_t(rng.Next()) << 18 >> (i % 50);
            Float values[Lanes64Count];
            tables.RadicalInverses(int(first), a, values);
            for (size_t lane = 0; lane < Lanes64Count && first + lane < multipliers.size(); ++lane) {
                const size_t d = first + lane;
                const uint64_t seed = DigitPermutations::SeedOf(5, int(d));
                ASSERT_NEAR(values[lane], test::AffineRadicalInverse(Primes[d], a, multipliers[d], seed), 1.2e-7f)
                    << d << " " << a;
            }
        }
    // A number does not depend on its neighbours.
    Float a[Lanes64Count], b[Lanes64Count];
    for (uint64_t index = 0; index < 100000; index += 7) {
        tables.RadicalInverses(5, index, a);
        tables.RadicalInverses(8, index, b);
        for (int lane = 0; lane < Lanes64Count - 3; ++lane) ASSERT_EQ(a[lane + 3], b[lane]);
    }
}

}  // namespace
}  // namespace pbrt
