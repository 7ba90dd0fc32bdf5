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
    auto seeds = std::make_shared<std::vector<uint64_t>>(SobolTableRow);
    for (int d = 0; d < SobolTableRow; d += Lanes64Count) StoreLanes(AddDimensions(seed_, d), &(*seeds)[d]);
    seeds_ = std::move(seeds);
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
    const uint64_t *seeds = seeds_->data() + first;
    const SixteenLanes seed{LoadLanes<Lanes64>(seeds), LoadLanes<Lanes64>(seeds + Lanes64Count)};
    if (settings_.randomization == Randomization::PermuteDigits) return FractionsToFloat(v ^ seed.Low());
    return RandomizedReversed(ReverseBits(v), settings_.randomization, seed);
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
