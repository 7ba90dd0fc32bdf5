#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "ext/lab/tile_statistics.h"

namespace pbrt::lab {

/// A rectangle of tiles, half-open.
struct TileRectangle {
    int x0, y0, x1, y1;
    int Count() const { return (x1 - x0) * (y1 - y0); }
};

/// The median of unsorted values; infinity if there are none.
double Median(std::vector<double> values);

/// How far the largest of `values`, which scatter about 0, rises above what ordinary noise explains (three robust
/// standard deviations); never negative.
double Excess(const std::vector<double> &values);

/// Mean and noise of the weighted tile means of equally good pictures, one channel.
class TileNoise {
  public:
    TileNoise(std::span<const TileMeans> pictures, int channel, const std::vector<double> &weights);

    /// Fewer pictures than this often agree by chance where most of the noise is.
    static constexpr size_t kFew = 4;

    size_t Pictures() const { return n_; }
    double Mean(size_t tile) const { return mean_[tile]; }

    struct Estimate {
        double variance = 0, dof = 0;
    };
    /// Noise of the mean over a region; needs at least two pictures.
    Estimate Of(const TileRectangle &r) const;

    /// Excess of the strongest tile of a single picture within `r`; needs at least two pictures.
    double Strongest(const TileRectangle &r) const;

  private:
    double Residual(size_t picture, int x, int y) const {
        return residual_[picture * mean_.size() + static_cast<size_t>(grid_.Index(x, y))];
    }
    TileGrid grid_;
    size_t n_ = 0;
    std::vector<double> mean_, residual_;
};

}  // namespace pbrt::lab
