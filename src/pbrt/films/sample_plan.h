#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/math/bounds.h"

namespace pbrt {

/// The film's pixels in cells: squares of kSize, of which one cell has the pixels of one colour of a checkerboard, and
/// one the others. The pixels of a cell have the same number of samples in adaptive renders.
class PixelCells {
  public:
    static constexpr int kSize = 8;
    explicit PixelCells(const Bounds2i &pixels)
        : pixels_(pixels), columns_((pixels.Width() + kSize - 1) / kSize),
          rows_((pixels.Height() + kSize - 1) / kSize) {}

    size_t Count() const { return 2 * size_t(columns_) * rows_; }
    size_t IndexOf(Point2i pixel) const {
        const Point2i p = pixel - pixels_.low;
        return Index(p.x / kSize, p.y / kSize, (p.x + p.y) % 2);
    }
    /// The cell of the other colour in the same square.
    static size_t Other(size_t cell) { return cell ^ 1; }
    /// May be zero.
    int PixelsIn(size_t cell) const { return int((SquareOf(cell).Area() + 1 - int64_t(cell % 2)) / 2); }
    void ForPixels(size_t cell, auto &&f) const {
        const Bounds2i square = SquareOf(cell);
        for (int y = square.low.y; y < square.high.y; ++y)
            for (int x = square.low.x; x < square.high.x; ++x)
                if (IndexOf({x, y}) == cell) f(Point2i(x, y));
    }
    /// Calls f(index) for the cell and its up to 8 neighbours of the same colour.
    void ForNeighbours(size_t cell, auto &&f) const {
        const int x = int(cell / 2 % columns_), y = int(cell / 2 / columns_);
        for (int j = std::max(0, y - 1); j <= std::min(rows_ - 1, y + 1); ++j)
            for (int i = std::max(0, x - 1); i <= std::min(columns_ - 1, x + 1); ++i) f(Index(i, j, int(cell % 2)));
    }

  private:
    size_t Index(int column, int row, int color) const { return 2 * (size_t(row) * columns_ + column) + color; }
    Bounds2i SquareOf(size_t cell) const {
        const Point2i low = pixels_.low + kSize * Point2i(int(cell / 2 % columns_), int(cell / 2 / columns_));
        return {low, glm::min(low + kSize, pixels_.high)};
    }

    Bounds2i pixels_;
    int columns_, rows_;
};

/// Samples per pixel of each cell while an adaptive render goes from `begin` to `end` samples per pixel on average.
struct SamplePlan {
    static constexpr int kMaxCount = 1 << 23;            ///< of a pixel
    static constexpr int kMaxGrowth = 4;                 ///< `after` over `before`, but for rounding
    static constexpr int kMinGroup = 4, kMaxGroup = 16;  ///< see Group
    /// Minimum predicted efficiency of unequal over equal numbers of samples, as long as these are equal. Once the
    /// numbers differ, kMinFurtherGain is enough.
    static constexpr double kMinGain = 1.1, kMinFurtherGain = 1.01;

    int begin = 0, end = 0;
    std::vector<int> before{}, after{};  ///< by cell, at `begin` and at `end`; empty: all pixels have the average
    /// Cost of all samples of a cell since the start: rays, and look-ups in media.
    std::vector<uint64_t> cost{};
    /// The half film receives every second block of this many samples, a power of 4: such blocks of low-discrepancy
    /// sequences are stratified. In pixels of every second row blocks have a quarter of the samples, so that the halves
    /// also show what stratification gains. 1: single samples in all pixels, as sample sets are independent. Not
    /// stored.
    int halfBlock = 1;
    int decisions = 0, uniformDecisions = 0;  ///< after the pilot, including the one that made this plan
    double gain = 0;                          ///< predicted by that one, see PredictGain
    bool isUniform = false;                   ///< that one plans towards equal numbers

    bool HasShortBlocks(Point2i pixel) const { return halfBlock > 1 && pixel.y % 2 != 0; }
    int BlockOf(Point2i pixel) const { return HasShortBlocks(pixel) ? halfBlock / 4 : halfBlock; }
    bool IsInHalf(Point2i pixel, int sample) const { return sample / BlockOf(pixel) % 2 != 0; }
    /// Number of the pixel's first `samples` that the half film receives.
    int CountInHalf(Point2i pixel, int samples) const {
        const int block = BlockOf(pixel), pair = 2 * block;
        return samples / pair * block + std::max(0, samples % pair - block);
    }
    /// Samples are added to pixels in groups of this many, which are stratified among themselves.
    int Group() const { return std::clamp(halfBlock, kMinGroup, kMaxGroup); }
    /// Samples of the cell's pixels when all pixels have `average`, in [begin, end].
    int CountAt(size_t cell, int average) const {
        if (before.empty()) return average;
        const int64_t added = after[cell] - before[cell];
        return before[cell] + (end > begin ? int(added * (average - begin) / (end - begin)) : 0);
    }
    void Visit(auto &archive) {
        archive(begin, end, before, after, cost, decisions, uniformDecisions, gain, isUniform);
    }
    /// Returns the error of a plan that does not fit `average` and the film; empty if it does.
    std::optional<std::string> Validate(const PixelCells &cells, int average) const {
        bool isValid = begin >= 0 && begin <= average && average <= end && end <= kMaxCount &&
                       before.size() == after.size() && cost.size() == cells.Count() &&
                       (before.empty() || before.size() == cells.Count()) && uniformDecisions >= int(isUniform) &&
                       uniformDecisions <= decisions && gain >= 0 && std::isfinite(gain);
        double excess = 0;  // of samples over the average
        for (size_t i = 0; isValid && i < before.size(); ++i) {
            isValid = before[i] >= 0 && before[i] <= after[i] && after[i] <= kMaxCount &&
                      after[i] <= kMaxGrowth * before[i] + kMaxGroup;
            excess += cells.PixelsIn(i) * double(after[i] - end - kMaxGroup);
        }
        return isValid && excess <= 0 ? std::nullopt : std::optional("its sample counts per cell are invalid");
    }
};

}  // namespace pbrt
