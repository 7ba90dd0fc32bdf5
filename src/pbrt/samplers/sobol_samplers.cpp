#include "pbrt/samplers/sobol_samplers.h"

#include <array>

namespace pbrt {

namespace {

int Log2RoundedUp(int v) { return std::bit_width(static_cast<unsigned>(std::max(1, v)) - 1); }

/// Consecutive dimensions of one hashed state.
uint64_t AddDimension(uint64_t hash, int dimension) {
    return MixBits(hash + 0x9e3779b97f4a7c15ull * static_cast<uint64_t>(dimension + 1));
}
/// A seed for the second of two coordinates. A full hash: a product would tie its low bits to those of the first.
uint64_t SecondSeed(uint64_t seed) { return MixBits(seed ^ 0x632be59bd9b4e019ull); }

/// All orders of four children, two bits for each.
constexpr std::array<uint8_t, 24> AllQuadOrders() {
    std::array<uint8_t, 24> orders{};
    size_t n = 0;
    for (unsigned a = 0; a < 4; ++a)
        for (unsigned b = 0; b < 4; ++b)
            for (unsigned c = 0; c < 4; ++c)
                if (a != b && a != c && b != c)
                    orders[n++] = static_cast<uint8_t>(a | b << 2 | c << 4 | (6 - a - b - c) << 6);
    return orders;
}
constexpr std::array<uint8_t, 24> kQuadOrders = AllQuadOrders();

}  // namespace

// ---- Global

SobolSampler::SobolSampler(int samplesPerPixel, Point2i resolution, Randomization randomization, int seed)
    : samplesPerPixel_(samplesPerPixel),
      randomization_(randomization),
      seed_(Hash(seed)),
      log2Resolution_(Log2RoundedUp(std::max(resolution.x, resolution.y))),
      pixelIndex_(std::make_shared<const SobolPixelIndex>(log2Resolution_)),
      matrices_(SobolMatrices()) {}

void SobolSampler::StartPixelSample(Point2i pixel, int sampleIndex, int dimension) {
    uint32_t mask = (1u << log2Resolution_) - 1;
    index_ = (*pixelIndex_)(static_cast<uint64_t>(sampleIndex), static_cast<uint32_t>(pixel.x) & mask,
                            static_cast<uint32_t>(pixel.y) & mask);
    dimension_ = std::max(2, dimension);
}

Point2 SobolSampler::GetPixel2D() {
    // What is left of each coordinate after the digits that name the pixel.
    return {SobolToFloat(SobolBits(matrices_, index_) << log2Resolution_),
            SobolToFloat(SobolBits(matrices_ + SobolIndexBits, index_) << log2Resolution_)};
}

Float SobolSampler::Dimension(int dimension) const {
    uint64_t seed = AddDimension(seed_, dimension);
    if (dimension >= SobolDimensions) return HashToFloat(MixBits(seed ^ MixBits(index_)));
    return Randomized(SobolBits(matrices_ + static_cast<size_t>(dimension) * SobolIndexBits, index_), randomization_,
                      seed);
}

// ---- Padded

void PaddedSobolSampler::StartPixelSample(Point2i pixel, int sampleIndex, int dimension) {
    int round = sampleIndex / samplesPerPixel_;
    index_ = static_cast<uint32_t>(sampleIndex - round * samplesPerPixel_);
    pixelHash_ = Hash(pixel, seed_, round);
    dimension_ = dimension;
}

Float PaddedSobolSampler::Get1D() {
    uint64_t seed = AddDimension(pixelHash_, dimension_);
    dimension_ += 1;
    uint32_t i = PermutationElement(index_, static_cast<uint32_t>(samplesPerPixel_), seed);
    return RandomizedReversed(SobolReversed0(i), randomization_, seed);
}

Point2 PaddedSobolSampler::Get2D() {
    uint64_t seed = AddDimension(pixelHash_, dimension_);
    dimension_ += 2;
    uint32_t i = PermutationElement(index_, static_cast<uint32_t>(samplesPerPixel_), seed);
    return {RandomizedReversed(SobolReversed0(i), randomization_, seed),
            RandomizedReversed(SobolReversed1(i), randomization_, SecondSeed(seed))};
}

// ---- Z order

ZSobolSampler::ZSobolSampler(int samplesPerPixel, Point2i resolution, Randomization randomization, int seed)
    : samplesPerPixel_(samplesPerPixel),
      randomization_(randomization),
      seed_(Hash(seed)),
      log2Samples_(Log2RoundedUp(samplesPerPixel)),
      indexBits_(log2Samples_ + 2 * Log2RoundedUp(std::max(resolution.x, resolution.y))) {}

void ZSobolSampler::StartPixelSample(Point2i pixel, int sampleIndex, int dimension) {
    int round = sampleIndex / samplesPerPixel_;
    roundSeed_ = seed_ + static_cast<uint64_t>(round) * 0xbf58476d1ce4e5b9ull;
    morton_ = EncodeMorton2(static_cast<uint32_t>(pixel.x), static_cast<uint32_t>(pixel.y)) << log2Samples_ |
              static_cast<uint64_t>(sampleIndex - round * samplesPerPixel_);
    dimension_ = dimension;
}

uint64_t ZSobolSampler::SobolIndex(uint64_t hash) const {
    uint64_t index = 0;
    int shift = log2Samples_ & 1;
    // The samples of a pixel go on below the pixels, four by four. A lone last bit is a pair in random order.
    if (shift) index = (morton_ & 1) ^ (MixBits(hash ^ (morton_ >> 1)) >> 63);
    for (uint64_t level = hash; shift < indexBits_; shift += 2) {
        level += 0x9e3779b97f4a7c15ull;
        uint64_t quad = MixBits(level ^ (morton_ >> (shift + 2))) >> 32;
        unsigned order = kQuadOrders[quad * 24 >> 32];
        uint64_t child = morton_ >> shift & 3;
        index |= uint64_t(order >> (2 * child) & 3) << shift;
    }
    return index;
}

uint64_t ZSobolSampler::DimensionHash() const { return AddDimension(roundSeed_, dimension_); }

Float ZSobolSampler::Get1D() {
    uint64_t hash = DimensionHash();
    dimension_ += 1;
    return RandomizedReversed(SobolReversed0(SobolIndex(hash)), randomization_, SecondSeed(hash));
}

Point2 ZSobolSampler::Get2D() {
    uint64_t hash = DimensionHash();
    dimension_ += 2;
    uint64_t i = SobolIndex(hash), seed = SecondSeed(hash);
    return {RandomizedReversed(SobolReversed0(i), randomization_, seed),
            RandomizedReversed(SobolReversed1(i), randomization_, SecondSeed(seed))};
}

}  // namespace pbrt
