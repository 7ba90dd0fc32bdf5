#include "pbrt/samplers/sobol_samplers.h"

namespace pbrt {
namespace {

int Log2RoundedUp(int v) { return std::bit_width(unsigned(std::max(1, v)) - 1); }

void SetSobolPoints(const SixteenLanes &index, Randomization randomization, const SixteenLanes &seedX, FloatLanes *x,
                    FloatLanes *y) {
    const Lanes32 low = index.Low();
    *x = RandomizedReversed(low, randomization, seedX);
    const Lanes32 second = SobolReversed1OfHalf(low) ^ SobolReversed1OfHalf(index.High());
    *y = RandomizedReversed(second, randomization, SecondSeed(seedX));
}

}  // namespace

SobolSampler::SobolSampler(const SamplerSettings &settings)
    : SamplerBySettings(settings), seed_(Hash(settings.seed)),
      log2Resolution_(Log2RoundedUp(std::max(settings.resolution.x, settings.resolution.y))),
      pixelIndex_(std::make_shared<const SobolPixelIndex>(log2Resolution_)), tables_(SobolTables()) {
    Seeds seeds;
    for (int d = 0; d < SobolTableRow; d += Lanes64Count) {
        const Lanes64 eight = AddDimensions(seed_, d);
        for (int lane = 0; lane < Lanes64Count; ++lane) {
            seeds.low.push_back(uint32_t(eight[lane]));
            seeds.high.push_back(uint32_t(eight[lane] >> 32));
        }
    }
    seeds_ = std::make_shared<const Seeds>(std::move(seeds));
}

int SobolSampler::StartSample(Point2i pixel, int sampleIndex, int dimension) {
    uint32_t mask = (1u << log2Resolution_) - 1;
    index_ = (*pixelIndex_)(uint64_t(sampleIndex), uint32_t(pixel.x) & mask, uint32_t(pixel.y) & mask);
    return std::max(2, dimension);
}

Point2 SobolSampler::GetPixel2D() {
    // Fraction of each coordinate after the pixel's digits.
    return {SobolToFloat(SobolBitsByTable(tables_, index_) << log2Resolution_),
            SobolToFloat(SobolBitsByTable(tables_ + 1, index_) << log2Resolution_)};
}

FloatLanes SobolSampler::SixteenDimensions(int first) const {
    Lanes32 v{};
    const uint32_t *rows = tables_ + first;
    for (uint64_t bits = index_; bits; bits >>= 4, rows += 16 * SobolTableRow)
        v ^= LoadLanes<Lanes32>(rows + (bits & 15) * SobolTableRow);
    const auto low = LoadLanes<Lanes32>(seeds_->low.data() + first),
               high = LoadLanes<Lanes32>(seeds_->high.data() + first);
    switch (settings_.randomization) {
        case Randomization::FastOwen: v = ReverseBits(FastOwenScrambleReversed(ReverseBits(v), low, high)); break;
        case Randomization::Owen:
            for (int half = 0; half < 2; ++half) {
                Lanes64 bits, seed;
                for (int i = 0; i < Lanes64Count; ++i) {
                    bits[i] = v[half * Lanes64Count + i];
                    seed[i] = uint64_t(high[half * Lanes64Count + i]) << 32 | low[half * Lanes64Count + i];
                }
                bits = OwenScramble(bits, seed);
                for (int i = 0; i < Lanes64Count; ++i) v[half * Lanes64Count + i] = uint32_t(bits[i]);
            }
            break;
        case Randomization::PermuteDigits: v ^= low; break;
        default: break;
    }
    return FractionsToFloat(v);
}

Sampler::Run SobolSampler::Prepare(int dimension, Numbers &numbers) {
    FloatLanes values{};
    if (dimension < SobolDimensions) values = SixteenDimensions(dimension);
    for (int d = std::max(dimension, SobolDimensions); d < dimension + kPrepared; ++d) {
        const uint64_t seed = MixBits(seed_ + 0x9e3779b97f4a7c15ull * uint64_t(d + 1));
        values[d - dimension] = HashToFloat(MixBits(seed ^ MixBits(index_)));
    }
    numbers.SetSequence(values);
    return {dimension, kPrepared - 1};
}

int PaddedSobolSampler::StartSample(Point2i pixel, int sampleIndex, int dimension) {
    int round = sampleIndex / SamplesPerPixel();
    index_ = uint32_t(sampleIndex - round * SamplesPerPixel());
    pixelHash_ = Hash(pixel, settings_.seed, round);
    return dimension;
}

Sampler::Run PaddedSobolSampler::Prepare(int dimension, Numbers &numbers) {
    const SixteenLanes seed{AddDimensions(pixelHash_, dimension), AddDimensions(pixelHash_, dimension + Lanes64Count)};
    const auto count = uint32_t(SamplesPerPixel());
    FloatLanes x, y;
    SetSobolPoints({PermutationElement(index_, count, seed.a), PermutationElement(index_, count, seed.b)},
                   settings_.randomization, seed, &x, &y);
    numbers.SetPoints(x, y);
    return {dimension, kPrepared};
}

ZSobolSampler::ZSobolSampler(const SamplerSettings &settings)
    : SamplerBySettings(settings), seed_(Hash(settings.seed)), log2Samples_(Log2RoundedUp(settings.samplesPerPixel)),
      indexBits_(log2Samples_ + 2 * Log2RoundedUp(std::max(settings.resolution.x, settings.resolution.y))) {}

int ZSobolSampler::StartSample(Point2i pixel, int sampleIndex, int dimension) {
    int round = sampleIndex / SamplesPerPixel();
    if (pixel != pixel_ || round != round_) {
        pixel_ = pixel;
        round_ = round;
        pixelPartKnown_ = 0;
        roundSeed_ = seed_ + uint64_t(round) * 0xbf58476d1ce4e5b9ull;
        pixelMorton_ = EncodeMorton2(uint32_t(pixel.x), uint32_t(pixel.y)) << log2Samples_;
    }
    morton_ = pixelMorton_ | uint64_t(sampleIndex - round * SamplesPerPixel());
    return dimension;
}

Lanes64 ZSobolSampler::PermutedQuads(const Lanes64 &hash, int fromBit, int toBit) const {
    Lanes64 index{};
    Lanes64 level = hash + 0x9e3779b97f4a7c15ull * uint64_t(fromBit / 2);
    for (int shift = fromBit; shift < toBit; shift += 2) {
        level += 0x9e3779b97f4a7c15ull;
        Lanes64 quad = (level ^ (morton_ >> (shift + 2))) * 0x7fb5d329728ea185ull;
        quad = ((quad ^ (quad >> 32)) * 0x81dadef4bc2dd44dull) >> 32;
        index |= PlaceInQuad(morton_ >> shift & 3, quad) << shift;
    }
    return index;
}

Lanes64 ZSobolSampler::SobolIndices(int firstDimension, const Lanes64 &hash) {
    // Quads down to the pixel are common to all its samples.
    Lanes64 index;
    if (firstDimension < kRemembered) {
        const uint32_t known = 1u << (firstDimension / Lanes64Count);
        uint64_t *const part = &pixelPart_[firstDimension];
        if (!(pixelPartKnown_ & known)) {
            StoreLanes(PermutedQuads(hash, log2Samples_, indexBits_), part);
            pixelPartKnown_ |= known;
        }
        index = LoadLanes<Lanes64>(part);
    } else {
        index = PermutedQuads(hash, log2Samples_, indexBits_);
    }
    // Below the pixel, quads group its samples; with an odd number of bits, the last bit is a pair in random order.
    int lone = log2Samples_ & 1;
    if (lone) index |= (morton_ & 1) ^ (MixBits(hash ^ (morton_ >> 1)) >> 63);
    return index | PermutedQuads(hash, lone, log2Samples_);
}

Sampler::Run ZSobolSampler::Prepare(int dimension, Numbers &numbers) {
    // Runs are aligned to their length, so that pixelPart_ is filled by whole vectors.
    const int first = dimension - dimension % kPrepared;
    const SixteenLanes hash{AddDimensions(roundSeed_, first), AddDimensions(roundSeed_, first + Lanes64Count)};
    FloatLanes x, y;
    SetSobolPoints({SobolIndices(first, hash.a), SobolIndices(first + Lanes64Count, hash.b)}, settings_.randomization,
                   SecondSeed(hash), &x, &y);
    numbers.SetPoints(x, y);
    return {first, kPrepared};
}

}  // namespace pbrt
