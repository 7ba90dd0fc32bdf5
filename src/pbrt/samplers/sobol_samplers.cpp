#include "pbrt/samplers/sobol_samplers.h"

#include <array>

namespace pbrt {

namespace {

int Log2RoundedUp(int v) { return std::bit_width(static_cast<unsigned>(std::max(1, v)) - 1); }

/// A hash for one dimension of a hashed state.
uint64_t AddDimension(uint64_t hash, int dimension) {
    return MixBits(hash + 0x9e3779b97f4a7c15ull * static_cast<uint64_t>(dimension + 1));
}
/// A seed for the second of two coordinates. It is a full hash, because with a product its low bits would depend on
/// those of the first seed.
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
    : Sampler(seed),
      samplesPerPixel_(samplesPerPixel),
      resolution_(resolution),
      randomization_(randomization),
      seed_(Hash(seed)),
      log2Resolution_(Log2RoundedUp(std::max(resolution.x, resolution.y))),
      pixelIndex_(std::make_shared<const SobolPixelIndex>(log2Resolution_)),
      tables_(SobolTables()) {}

void SobolSampler::StartPixelSample(Point2i pixel, int sampleIndex, int dimension) {
    uint32_t mask = (1u << log2Resolution_) - 1;
    index_ = (*pixelIndex_)(static_cast<uint64_t>(sampleIndex), static_cast<uint32_t>(pixel.x) & mask,
                            static_cast<uint32_t>(pixel.y) & mask);
    dimension_ = std::max(2, dimension);
}

Point2 SobolSampler::GetPixel2D() {
    // What is left of each coordinate after the digits that name the pixel.
    return {SobolToFloat(SobolBitsByTable(tables_, index_) << log2Resolution_),
            SobolToFloat(SobolBitsByTable(tables_ + SobolTableStride, index_) << log2Resolution_)};
}

Float SobolSampler::Dimension(int dimension) const {
    uint64_t seed = AddDimension(seed_, dimension);
    if (dimension >= SobolDimensions) return HashToFloat(MixBits(seed ^ MixBits(index_)));
    return Randomized(SobolBitsByTable(tables_ + static_cast<size_t>(dimension) * SobolTableStride, index_),
                      randomization_, seed);
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
    : Sampler(seed),
      samplesPerPixel_(samplesPerPixel),
      resolution_(resolution),
      randomization_(randomization),
      seed_(Hash(seed)),
      log2Samples_(Log2RoundedUp(samplesPerPixel)),
      indexBits_(log2Samples_ + 2 * Log2RoundedUp(std::max(resolution.x, resolution.y))) {}

void ZSobolSampler::StartPixelSample(Point2i pixel, int sampleIndex, int dimension) {
    int round = sampleIndex / samplesPerPixel_;
    if (pixel != pixel_ || round != round_) {
        pixel_ = pixel;
        round_ = round;
        pixelPartKnown_ = 0;
        roundSeed_ = seed_ + static_cast<uint64_t>(round) * 0xbf58476d1ce4e5b9ull;
        pixelMorton_ = EncodeMorton2(static_cast<uint32_t>(pixel.x), static_cast<uint32_t>(pixel.y)) << log2Samples_;
    }
    morton_ = pixelMorton_ | static_cast<uint64_t>(sampleIndex - round * samplesPerPixel_);
    dimension_ = dimension;
}

uint64_t ZSobolSampler::PermutedQuads(uint64_t hash, int fromBit, int toBit) const {
    uint64_t index = 0;
    uint64_t level = hash + 0x9e3779b97f4a7c15ull * static_cast<uint64_t>(fromBit / 2);
    for (int shift = fromBit; shift < toBit; shift += 2) {
        level += 0x9e3779b97f4a7c15ull;
        uint64_t quad = (level ^ (morton_ >> (shift + 2))) * 0x7fb5d329728ea185ull;
        quad = ((quad ^ (quad >> 32)) * 0x81dadef4bc2dd44dull) >> 32;
        unsigned order = kQuadOrders[quad * 24 >> 32];
        uint64_t child = morton_ >> shift & 3;
        index |= uint64_t(order >> (2 * child) & 3) << shift;
    }
    return index;
}

uint64_t ZSobolSampler::SobolIndex(uint64_t hash) {
    // The quads down to the pixel are the same for all its samples.
    auto slot = static_cast<size_t>(dimension_);
    uint64_t index;
    if (slot < kRemembered && (pixelPartKnown_ >> slot & 1))
        index = pixelPart_[slot];
    else {
        index = PermutedQuads(hash, log2Samples_, indexBits_);
        if (slot < kRemembered) {
            pixelPart_[slot] = index;
            pixelPartKnown_ |= uint64_t(1) << slot;
        }
    }
    // Below the pixel the quads group its samples. If these have an odd number of bits, the last bit is a pair in
    // random order.
    int lone = log2Samples_ & 1;
    if (lone) index |= (morton_ & 1) ^ (MixBits(hash ^ (morton_ >> 1)) >> 63);
    return index | PermutedQuads(hash, lone, log2Samples_);
}

uint64_t ZSobolSampler::DimensionHash() const { return AddDimension(roundSeed_, dimension_); }

Float ZSobolSampler::Get1D() {
    uint64_t hash = DimensionHash(), i = SobolIndex(hash);
    dimension_ += 1;
    return RandomizedReversed(SobolReversed0(i), randomization_, SecondSeed(hash));
}

Point2 ZSobolSampler::Get2D() {
    uint64_t hash = DimensionHash(), i = SobolIndex(hash), seed = SecondSeed(hash);
    dimension_ += 2;
    return {RandomizedReversed(SobolReversed0(i), randomization_, seed),
            RandomizedReversed(SobolReversed1(i), randomization_, SecondSeed(seed))};
}

}  // namespace pbrt
