#include <gtest/gtest.h>

#include "pbrt/samplers/random_samplers.h"
#include "pbrt/samplers/sobol_samplers.h"
#include "sampler_cases.h"

// The samplers that work on several dimensions at once against slow twins that compute one number at a time.

namespace pbrt::test {
namespace {

constexpr uint64_t kGolden = 0x9e3779b97f4a7c15ull;

uint64_t AddDimension(uint64_t hash, int dimension) { return MixBits(hash + kGolden * uint64_t(dimension + 1)); }
uint64_t SecondSeed(uint64_t seed) { return MixBits(seed ^ 0x632be59bd9b4e019ull); }

/// One coordinate from bits in reversed order.
Float Randomize(uint32_t reversed, const std::string &randomization, uint64_t seed) {
    if (randomization == "fastowen") return SobolToFloat(ReverseBits(FastOwenScrambleReversed(reversed, seed)));
    if (randomization == "owen") return SobolToFloat(OwenScramble(ReverseBits(reversed), seed));
    if (randomization == "permutedigits") reversed ^= uint32_t(seed);
    return SobolToFloat(ReverseBits(reversed));
}

/// The place of one child among its siblings: the orders of four in lexicographic order.
uint64_t Place(uint64_t child, uint64_t order) {
    std::vector<uint64_t> places{0, 1, 2, 3};
    for (uint64_t i = 0; i < order; ++i) std::next_permutation(places.begin(), places.end());
    return places[child];
}

/// Ahmed and Wonka's order, quad by quad.
uint64_t ZIndex(uint64_t morton, int log2Samples, int bits, uint64_t hash) {
    uint64_t index = 0;
    const int lone = log2Samples & 1;
    if (lone) index |= (morton & 1) ^ (MixBits(hash ^ (morton >> 1)) >> 63);
    for (int shift = lone; shift < bits; shift += 2) {
        // Quads below the pixel and above it are counted apart.
        const int level = shift < log2Samples ? (shift - lone) / 2 : log2Samples / 2 + (shift - log2Samples) / 2;
        uint64_t quad = ((hash + kGolden * uint64_t(level + 1)) ^ (morton >> (shift + 2))) * 0x7fb5d329728ea185ull;
        quad = ((quad ^ (quad >> 32)) * 0x81dadef4bc2dd44dull) >> 32;
        index |= Place(morton >> shift & 3, quad * 24 >> 32) << shift;
    }
    return index;
}

TEST(SobolTwins, ZSobolEqualsItsTwin) {
    constexpr Point2i kResolution(200, 90);  // 2^8 pixels in the larger direction
    for (const char *randomization : kRandomizations)
        for (int samples : {1, 2, 8, 16, 37}) {
            std::unique_ptr<Sampler> s = SamplerCase{"zsobol", randomization}.Make(samples, 4, kResolution);
            const int log2Samples = std::bit_width(unsigned(samples) - 1);
            for (Point2i pixel : {Point2i(0, 0), Point2i(77, 12), Point2i(199, 89)})
                for (int i : {0, samples - 1, samples + samples / 2}) {
                    const int round = i / samples;
                    const uint64_t seed = Hash(4) + uint64_t(round) * 0xbf58476d1ce4e5b9ull;
                    const uint64_t morton = EncodeMorton2(uint32_t(pixel.x), uint32_t(pixel.y)) << log2Samples |
                                            uint64_t(i - round * samples);
                    s->StartPixelSample(pixel, i);
                    for (int d = 0; d < 160; d += 3) {
                        auto expected = [&](int dimension) {
                            const uint64_t hash = AddDimension(seed, dimension), seedX = SecondSeed(hash);
                            const uint64_t index = ZIndex(morton, log2Samples, log2Samples + 16, hash);
                            return Point2(Randomize(SobolReversed0(index), randomization, seedX),
                                          Randomize(SobolReversed1(index), randomization, SecondSeed(seedX)));
                        };
                        ASSERT_EQ(s->Get1D(), expected(d).x) << randomization << " " << samples << " " << d;
                        ASSERT_EQ(s->Get2D(), expected(d + 1)) << randomization << " " << samples << " " << d;
                    }
                }
        }
}

TEST(SobolTwins, PaddedSobolEqualsItsTwin) {
    for (const char *randomization : kRandomizations)
        for (int samples : {1, 16, 37}) {
            std::unique_ptr<Sampler> s = SamplerCase{"paddedsobol", randomization}.Make(samples, 4);
            for (int i : {0, samples - 1, samples + samples / 2}) {
                const int round = i / samples;
                const auto place = uint32_t(i - round * samples);
                const uint64_t hash = Hash(Point2i(9, 5), 4, round);
                s->StartPixelSample({9, 5}, i);
                for (int d = 0; d < 90; d += 2) {
                    const uint64_t seed = AddDimension(hash, d);
                    const uint32_t index = PermutationElement(place, uint32_t(samples), seed);
                    const Point2 expected(Randomize(SobolReversed0(index), randomization, seed),
                                          Randomize(SobolReversed1(index), randomization, SecondSeed(seed)));
                    ASSERT_EQ(s->Get2D(), expected) << randomization << " " << samples << " " << d;
                }
            }
        }
}

TEST(SobolTwins, SobolEqualsItsTwin) {
    for (const auto &[randomization, r] : {std::pair("none", Randomization::None),
                                           {"permutedigits", Randomization::PermuteDigits},
                                           {"owen", Randomization::Owen},
                                           {"fastowen", Randomization::FastOwen}}) {
        SobolSampler s({16, {64, 48}, r, 4});
        s.StartPixelSample({30, 7}, 21);
        for (int d = 2; d < 1060; ++d) {
            const uint64_t seed = AddDimension(Hash(4), d);
            Float expected = HashToFloat(MixBits(seed ^ MixBits(s.Index())));
            if (d < SobolDimensions) {
                const uint32_t bits = SobolBits(SobolMatrices() + d * SobolIndexBits, s.Index());
                // Digits are permuted in their order here, not in reversed order.
                expected = r == Randomization::PermuteDigits ? SobolToFloat(bits ^ uint32_t(seed))
                                                             : Randomize(ReverseBits(bits), randomization, seed);
            }
            ASSERT_EQ(s.Get1D(), expected) << randomization << " " << d;
        }
    }
}

TEST(IndependentTwin, NumbersAreThoseOfThePixelsStream) {
    IndependentSampler s({.samplesPerPixel = 16, .seed = 3});
    for (int i : {0, 5, 40}) {
        const uint64_t hash = Hash(Point2i(3, 8), 3);
        Rng rng(hash, MixBits(hash));
        rng.Advance(uint64_t(i) * 65536);
        s.StartPixelSample({3, 8}, i);
        for (int d = 0; d < 50; ++d) ASSERT_EQ(s.Get1D(), rng.Uniform()) << i << " " << d;
    }
}

}  // namespace
}  // namespace pbrt::test
