#pragma once
#include <array>
#include <vector>

#include "pbrt/samplers/sobol_samplers.h"

namespace pbrt {

/// Permutation of 0 ... Size * Size - 1 over a tiling square of pixels, with similar ranks far apart (void and cluster,
/// Ulichney 1993): blue-noise thresholds.
class BlueNoiseMask {
  public:
    static constexpr int Log2Size = 6, Size = 1 << Log2Size;
    explicit BlueNoiseMask(uint64_t seed);
    uint32_t Rank(uint32_t x, uint32_t y) const { return ranks_[(y & (Size - 1)) << Log2Size | (x & (Size - 1))]; }

  private:
    std::vector<uint16_t> ranks_;
};

/// Point of the unit square as binary fractions: bit 31 is the first digit after the point.
struct BinaryPoint {
    uint32_t x = 0, y = 0;
};

/// First 2^log2Count points of a random progressive multi-jittered (0,2) sequence (Christensen, Kensler and Kilpatrick
/// 2018): in every aligned run of 2^m points, each box of any cut into 2^a columns and 2^(m-a) rows holds one. The
/// first 16, 64, ... 4^blueLevels points have blue noise, also across the square's borders. An Owen scrambling of
/// Sobol' points: any flips give a (0,2) sequence, so random flips are optimised for blue noise digit by digit (after
/// Perrier et al. 2018).
std::vector<BinaryPoint> MakePmj02bn(int log2Count, int blueLevels, uint64_t seed);

/// Progressive multi-jittered (0,2) points. Positions of all samples in a square of pixels are one blue-noise point
/// set. For other dimensions a pixel uses one of a few fixed sets, in a random order that keeps runs of 4, 16, ...
/// samples together. Digits are flipped by masks with blue noise over the image, which preserves the (0,2) property.
class Pmj02bnSampler final : public SamplerBySettings<Pmj02bnSampler> {
  public:
    explicit Pmj02bnSampler(const SamplerSettings &settings)
        : SamplerBySettings(settings), log2Samples_(std::bit_width(unsigned(settings.samplesPerPixel - 1))),
          seed_(Hash(settings.seed)) {
        log2PerPixel_ = std::min((log2Samples_ + 1) / 2 * 2, SetLog2Count);
        log2Tile_ = (SetLog2Count - log2PerPixel_) / 2;
        // The points in a pixel, in sequence order, are again a (0,2) sequence.
        auto sorted = std::make_shared<std::vector<BinaryPoint>>(size_t(1) << SetLog2Count);
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
    Point2 GetPixel2D() override {
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

    /// 2^SetLog2Count points per set; the first set is for positions. Built at the first call.
    static constexpr int SetCount = 6, SetLog2Count = 16;
    static const std::vector<BinaryPoint> &Set(int index) {
        using Sets = std::array<std::vector<BinaryPoint>, SetCount>;
        static const Sets sets = [] {
            Sets made;
            // Flipped digits destroy blue noise, so only the position set has it. In other sets its regular spacing
            // increases the measured pixel error.
            for (size_t i = 0; i < made.size(); ++i) made[i] = MakePmj02bn(SetLog2Count, i == 0 ? 7 : 0, i);
            return made;
        }();
        return sets[index];
    }

  protected:
    int StartSample(Point2i pixel, int sampleIndex, int dimension) override {
        pixel_ = pixel;
        index_ = sampleIndex;
        // Exhausted sets are reused, flipped and reordered.
        setHash_ = Hash(seed_, sampleIndex >> SetLog2Count);
        pixelHash_ = Hash(pixel, setHash_);
        return std::max(2, dimension);
    }
    Run Prepare(int dimension, Numbers &numbers) override {
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

  private:
    /// Permutes `bits`-bit numbers keeping every aligned run of 4, 16, ... together: the quarters of each run have
    /// their own random order, by the lane's seed.
    static Lanes64 ShuffleRuns(uint32_t index, int bits, const Lanes64 &seed) {
        Lanes64 shuffled{};
        for (int shift = 0; shift < bits; shift += 2) {
            const Lanes64 hash = MixBits(seed ^ (uint64_t(shift) << 32 | index >> (shift + 2)));
            const uint64_t part = index >> shift & 3;
            // If `bits` is odd, the highest bit alone is flipped randomly.
            shuffled |= (shift + 1 == bits ? part ^ (hash >> 63) : PlaceInQuad(part, hash >> 32)) << shift;
        }
        return shuffled;
    }
    /// Indices into the sets for four dimensions from the given one.
    Lanes64 PlacesFor(int dimension) const {
        // Each batch of 2^log2Samples_ samples takes the next run of as many points.
        const int bits = std::min(log2Samples_, SetLog2Count);
        const uint32_t mask = (uint32_t(1) << bits) - 1;
        const auto index = uint32_t(index_);
        const Lanes64 shuffled = ShuffleRuns(index & mask, bits, AddDimensions(pixelHash_, dimension));
        return (shuffled | uint64_t(index & ~mask)) & ((uint64_t(1) << SetLog2Count) - 1);
    }
    /// Their flip masks.
    Lanes64 FlipsFor(int dimension) const {
        // Each dimension offsets the mask by multiples of the inverse plastic number and its square (Roberts 2018),
        // which stay apart.
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

    std::array<const BinaryPoint *, SetCount> sets_;
    const BlueNoiseMask *mask_;
    int log2Samples_;  ///< log2 of the samples per pixel, rounded up
    uint64_t seed_;
    int log2Tile_;                                                 ///< side of a tile in pixels
    int log2PerPixel_;                                             ///< points of a tile per pixel
    std::shared_ptr<const std::vector<BinaryPoint>> pixelPoints_;  ///< of a tile, by pixel, as fractions of the pixel
    Point2i pixel_{};
    int index_ = 0;
    uint64_t pixelHash_ = 0, setHash_ = 0;
};

}  // namespace pbrt
