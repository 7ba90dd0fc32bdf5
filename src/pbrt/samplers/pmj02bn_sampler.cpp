#include "pbrt/samplers/pmj02bn_sampler.h"

#include "pbrt/samplers/sobol_samplers.h"

namespace pbrt {
namespace {

constexpr int kLog2Count = Pmj02bnSampler::SetLog2Count;

/// Permutes `bits`-bit numbers keeping every aligned run of 4, 16, ... together: the quarters of each run have their
/// own random order, by the lane's seed.
Lanes64 ShuffleRuns(uint32_t index, int bits, const Lanes64 &seed) {
    Lanes64 shuffled{};
    for (int shift = 0; shift < bits; shift += 2) {
        const Lanes64 hash = MixBits(seed ^ (uint64_t(shift) << 32 | index >> (shift + 2)));
        const uint64_t part = index >> shift & 3;
        // If `bits` is odd, the highest bit alone is flipped randomly.
        shuffled |= (shift + 1 == bits ? part ^ (hash >> 63) : PlaceInQuad(part, hash >> 32)) << shift;
    }
    return shuffled;
}

}  // namespace

const std::vector<BinaryPoint> &Pmj02bnSampler::Set(int index) {
    using Sets = std::array<std::vector<BinaryPoint>, SetCount>;
    static const Sets sets = [] {
        Sets made;
        // Flipped digits destroy blue noise, so only the position set has it. In other sets its regular spacing
        // increases the measured pixel error.
        for (size_t i = 0; i < made.size(); ++i) made[i] = MakePmj02bn(kLog2Count, i == 0 ? 7 : 0, i);
        return made;
    }();
    return sets[index];
}

Pmj02bnSampler::Pmj02bnSampler(const SamplerSettings &settings)
    : SamplerBySettings(settings), log2Samples_(std::bit_width(unsigned(settings.samplesPerPixel - 1))),
      seed_(Hash(settings.seed)) {
    log2PerPixel_ = std::min((log2Samples_ + 1) / 2 * 2, kLog2Count);
    log2Tile_ = (kLog2Count - log2PerPixel_) / 2;
    // The points in a pixel, in sequence order, are again a (0,2) sequence.
    auto sorted = std::make_shared<std::vector<BinaryPoint>>(size_t(1) << kLog2Count);
    std::vector<uint32_t> found(size_t(1) << (2 * log2Tile_), 0);
    auto place = [&](uint32_t v) { return uint32_t(uint64_t(v) >> (32 - log2Tile_)); };
    for (const BinaryPoint &p : Set(0)) {
        const uint32_t pixel = place(p.y) << log2Tile_ | place(p.x);
        (*sorted)[pixel << log2PerPixel_ | found[pixel]++] = {p.x << log2Tile_, p.y << log2Tile_};
    }
    pixelPoints_ = std::move(sorted);
    for (int i = 0; i < SetCount; ++i) sets_[i] = Set(i).data();
    static const BlueNoiseMask mask(0);
    mask_ = &mask;
}

int Pmj02bnSampler::StartSample(Point2i pixel, int sampleIndex, int dimension) {
    pixel_ = pixel;
    index_ = sampleIndex;
    // Exhausted sets are reused, flipped and reordered.
    setHash_ = Hash(seed_, sampleIndex >> kLog2Count);
    pixelHash_ = Hash(pixel, setHash_);
    return std::max(2, dimension);
}

Lanes64 Pmj02bnSampler::PlacesFor(int dimension) const {
    // Each batch of 2^log2Samples_ samples takes the next run of as many points.
    const int bits = std::min(log2Samples_, kLog2Count);
    const uint32_t mask = (uint32_t(1) << bits) - 1;
    const auto index = uint32_t(index_);
    const Lanes64 shuffled = ShuffleRuns(index & mask, bits, AddDimensions(pixelHash_, dimension));
    return (shuffled | uint64_t(index & ~mask)) & ((uint64_t(1) << kLog2Count) - 1);
}

Lanes64 Pmj02bnSampler::FlipsFor(int dimension) const {
    // Each dimension offsets the mask by multiples of the inverse plastic number and its square (Roberts 2018), which
    // stay apart.
    Lanes64 rank;
    for (int lane = 0; lane < Lanes64Count; ++lane) {
        const auto d = uint32_t(dimension + lane);
        const uint32_t x = (d * 0xc13fa9a9u) >> (32 - BlueNoiseMask::Log2Size),
                       y = (d * 0x91e10da5u) >> (32 - BlueNoiseMask::Log2Size);
        rank[lane] = mask_->Rank(uint32_t(pixel_.x) + x, uint32_t(pixel_.y) + y);
    }
    constexpr int kRankBits = 2 * BlueNoiseMask::Log2Size;
    const Lanes64 sameEverywhere = AddDimensions(setHash_, dimension);
    const Lanes64 fine = MixBits(pixelHash_ - 0x9e3779b97f4a7c15ull * CountingLanes(uint64_t(dimension)));
    return (rank << (32 - kRankBits) | fine >> (32 + kRankBits)) ^ sameEverywhere;
}

Sampler::Run Pmj02bnSampler::Prepare(int dimension, Numbers &numbers) {
    uint32_t x[kPrepared], y[kPrepared], flips[kPrepared];
    for (int half = 0; half < 2; ++half) {
        const int first = half * Lanes64Count;
        const Lanes64 places = PlacesFor(dimension + first), flipped = FlipsFor(dimension + first);
        for (int lane = 0; lane < Lanes64Count; ++lane) {
            const auto set = size_t(1 + (dimension + first + lane) % (SetCount - 1));
            const BinaryPoint p = sets_[set][places[lane]];
            x[first + lane] = p.x;
            y[first + lane] = p.y;
            flips[first + lane] = uint32_t(flipped[lane]);
        }
    }
    for (int i = 0; i < kPrepared - 1; ++i) {
        numbers.one[i] = SobolToFloat(x[i] ^ flips[i]);
        numbers.two[i] = {numbers.one[i], SobolToFloat(y[i] ^ flips[i + 1])};
    }
    return {dimension, kPrepared - 1};
}

Point2 Pmj02bnSampler::GetPixel2D() {
    // Tiles start at a seed-dependent pixel; further rounds through a tile's points flip their digits.
    const uint32_t mask = (uint32_t(1) << log2Tile_) - 1;
    const uint32_t x = (uint32_t(pixel_.x) + uint32_t(seed_)) & mask,
                   y = (uint32_t(pixel_.y) + uint32_t(seed_ >> 32)) & mask;
    const int round = index_ >> log2PerPixel_;
    const uint32_t inPixel = uint32_t(index_) & ((uint32_t(1) << log2PerPixel_) - 1);
    const BinaryPoint p = (*pixelPoints_)[(y << log2Tile_ | x) << log2PerPixel_ | inPixel];
    const uint64_t flips = round > 0 ? Hash(seed_, round) : 0;
    return {SobolToFloat(p.x ^ uint32_t(flips)), SobolToFloat(p.y ^ uint32_t(flips >> 32))};
}

}  // namespace pbrt
