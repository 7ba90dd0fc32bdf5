#include <cmath>
#include <functional>
#include <span>

#include "pbrt/core/error.h"
#include "pbrt/math/sobol.h"
#include "pbrt/samplers/pmj02bn_sampler.h"

namespace pbrt {
namespace {

constexpr int kSize = BlueNoiseMask::Size, kCount = kSize * kSize;

/// Set of chosen pixels, with an energy per pixel that grows near chosen ones.
class Pattern {
  public:
    Pattern() : bell_(kCount), chosen_(kCount, 0), energy_(kCount, 0) {
        constexpr float kSigma = 1.5f;  // pixels, as in Ulichney 1993
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                const auto dx = float(std::min(x, kSize - x)), dy = float(std::min(y, kSize - y));
                bell_[y * kSize + x] = std::exp(-(dx * dx + dy * dy) / (2 * kSigma * kSigma));
            }
    }
    bool IsChosen(int pixel) const { return chosen_[pixel] != 0; }
    void Toggle(int pixel) {
        uint8_t &chosen = chosen_[pixel];
        const float sign = chosen ? -1.0f : 1.0f;
        chosen ^= 1;
        const int px = pixel % kSize, py = pixel / kSize;
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x)
                energy_[y * kSize + x] += sign * bell_[((y - py) & (kSize - 1)) * kSize + ((x - px) & (kSize - 1))];
    }
    /// Toggles and returns the chosen pixel of highest energy.
    int RemoveTightestCluster() { return ToggleBest(true, std::greater<float>()); }
    /// Toggles and returns the pixel of lowest energy that is not chosen.
    int FillLargestVoid() { return ToggleBest(false, std::less<float>()); }

  private:
    int ToggleBest(bool chosen, auto isBetter) {
        int best = -1;
        for (int i = 0; i < kCount; ++i)
            if (IsChosen(i) == chosen && (best < 0 || isBetter(energy_[i], energy_[best]))) best = i;
        Toggle(best);
        return best;
    }
    std::vector<float> bell_;
    std::vector<uint8_t> chosen_;
    std::vector<float> energy_;
};

constexpr size_t X = 0, Y = 1;

/// Points with their Sobol' and flipped coordinates. A node of an axis is the set of points whose Sobol' coordinates
/// share their first digits.
struct Sequence {
    std::array<std::vector<uint32_t>, 2> sobol, flipped;

    Sequence(uint32_t count, uint64_t seed) {
        for (uint32_t i = 0; i < count; ++i)
            for (size_t axis : {X, Y}) {
                sobol[axis].push_back(ReverseBits(axis == X ? SobolReversed0(i) : SobolReversed1(i)));
                flipped[axis].push_back(OwenScramble(sobol[axis][i], Hash(seed, axis)));
            }
    }
    uint32_t Node(uint32_t i, size_t axis, int digits) const { return sobol[axis][i] >> (32 - digits); }
};

/// First 4^level points, one in each of 2^level x 2^level cells.
class Prefix {
  public:
    Prefix(const Sequence &sequence, int level) : sequence_(&sequence), level_(level) {
        const uint32_t count = uint32_t(1) << (2 * level);
        cells_.resize(count);
        for (size_t axis : {X, Y}) order_[axis].resize(count);
        for (uint32_t i = 0; i < count; ++i) {
            cells_[Row(sequence.flipped[Y][i]) << level | Row(sequence.flipped[X][i])] = i;
            for (size_t axis : {X, Y}) order_[axis][sequence.Node(i, axis, 2 * level)] = i;
        }
    }

    /// Points of the prefix in a node; `digits` at most 2 * level.
    std::span<const uint32_t> PointsIn(size_t axis, int digits, uint32_t node) const {
        const size_t count = size_t(1) << (2 * level_ - digits);
        return {order_[axis].data() + count * node, count};
    }
    int Level() const { return level_; }

    /// Mean energy of a node's points. Pairs within the node and across its border count once.
    float Energy(size_t axis, int digits, uint32_t node) const {
        float sum = 0;
        std::span<const uint32_t> points = PointsIn(axis, digits, node);
        for (uint32_t i : points)
            ForNeighbors(i, [&](uint32_t neighbor, float energy) {
                sum += sequence_->Node(neighbor, axis, digits) == node ? energy / 2 : energy;
            });
        return sum / float(points.size());
    }

  private:
    uint32_t Row(uint32_t coordinate) const { return coordinate >> (32 - level_); }

    void ForNeighbors(uint32_t i, const auto &f) const {
        const auto &[xs, ys] = sequence_->flipped;
        const float scale = float(1u << level_) * 0x1p-32f;
        const uint32_t mask = (1u << level_) - 1;
        const uint32_t column = Row(xs[i]), row = Row(ys[i]);
        for (uint32_t dy = 0; dy < 5; ++dy)
            for (uint32_t dx = 0; dx < 5; ++dx) {
                const uint32_t k = cells_[((row + dy - 2) & mask) << level_ | ((column + dx - 2) & mask)];
                if (k == i) continue;
                // Toroidal differences.
                const float u = float(int32_t(xs[k] - xs[i])) * scale, v = float(int32_t(ys[k] - ys[i])) * scale;
                const float q = 1 - (u * u + v * v) / (1.6f * 1.6f);
                if (q > 0) f(k, q * q * q * q);
            }
    }

    const Sequence *sequence_;
    int level_;
    std::vector<uint32_t> cells_;
    std::array<std::vector<uint32_t>, 2> order_;  ///< points by Sobol' coordinate
};

/// Decides for every node of `digits` digits whether the next digit of its points is flipped. `prefixes`: largest
/// first.
void SearchFlips(Sequence &sequence, int digits, std::span<const Prefix *const> prefixes) {
    const Prefix &largest = *prefixes.front();
    const uint32_t bit = uint32_t(1) << (31 - digits);
    constexpr int kSweeps = 3;
    for (size_t axis : {X, Y}) {
        std::vector<uint8_t> flips(size_t(1) << digits, 0);
        for (int sweep = 0; sweep < kSweeps; ++sweep)
            for (uint32_t node = 0; node < flips.size(); ++node) {
                auto energy = [&] {
                    float sum = 0;
                    for (const Prefix *p : prefixes) sum += p->Energy(axis, digits, node);
                    return sum;
                };
                auto flip = [&] {
                    for (uint32_t i : largest.PointsIn(axis, digits, node)) sequence.flipped[axis][i] ^= bit;
                };
                const float before = energy();
                flip();
                if (energy() < before) flips[node] ^= 1;
                else flip();
            }
        for (size_t i = size_t(1) << (2 * largest.Level()); i < sequence.flipped[axis].size(); ++i)
            if (flips[sequence.Node(uint32_t(i), axis, digits)]) sequence.flipped[axis][i] ^= bit;
    }
}

}  // namespace

BlueNoiseMask::BlueNoiseMask(uint64_t seed) : ranks_(kCount) {
    Pattern pattern;
    Rng rng(seed);
    int count = 0;
    while (count < kCount / 10) {
        const auto pixel = int(rng.UniformInt(kCount));
        if (pattern.IsChosen(pixel)) continue;
        pattern.Toggle(pixel);
        ++count;
    }
    // Distributes the initial pixels evenly.
    for (;;) {
        const int cluster = pattern.RemoveTightestCluster();
        if (pattern.FillLargestVoid() == cluster) break;
    }
    Pattern fewer = pattern;
    for (int rank = count - 1; rank >= 0; --rank) ranks_[fewer.RemoveTightestCluster()] = uint16_t(rank);
    for (int rank = count; rank < kCount; ++rank) ranks_[pattern.FillLargestVoid()] = uint16_t(rank);
}

std::vector<BinaryPoint> MakePmj02bn(int log2Count, int blueLevels, uint64_t seed) {
    PBRT_CHECK(log2Count <= 30 && 2 * blueLevels <= log2Count);
    Sequence sequence(uint32_t(1) << log2Count, seed);
    // A prefix's cells are fixed by the digits before its level. A digit moves the points of its own level's prefix by
    // half a cell, those of the two preceding levels by a quarter and an eighth.
    std::vector<Prefix> prefixes;
    for (int digit = 2; digit <= blueLevels + 2; ++digit) {
        if (digit <= blueLevels) prefixes.emplace_back(sequence, digit);
        std::vector<const Prefix *> moved;
        for (auto p = prefixes.rbegin(); p != prefixes.rend(); ++p)
            if (p->Level() >= digit - 2 && 2 * p->Level() >= digit) moved.push_back(&*p);
        if (!moved.empty()) SearchFlips(sequence, digit, moved);
    }
    std::vector<BinaryPoint> points;
    for (size_t i = 0; i < sequence.flipped[X].size(); ++i)
        points.push_back({sequence.flipped[X][i], sequence.flipped[Y][i]});
    return points;
}

}  // namespace pbrt
