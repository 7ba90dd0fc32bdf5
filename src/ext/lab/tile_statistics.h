#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "pbrt/images/image.h"

namespace ext::lab {
using namespace pbrt;

/// Calls f(x, y) for all pixels of an image, row by row.
template <class F>
void ForEachPixel(Point2i resolution, F &&f) {
    for (int y = 0; y < resolution.y; ++y)
        for (int x = 0; x < resolution.x; ++x) f(x, y);
}

/// Square tiles over an image. Pixels left over at the right and the bottom belong to the last tiles, so no tile is
/// smaller than tileSize unless the image is.
struct TileGrid {
    Point2i resolution{0, 0};
    int tileSize = 8;
    int tilesX = 0, tilesY = 0;

    TileGrid() = default;
    TileGrid(Point2i resolution, int tileSize);
    int Count() const { return tilesX * tilesY; }
    int Index(int x, int y) const { return y * tilesX + x; }
    Bounds2i Pixels(int x, int y) const;
    template <class F>
    void ForEachTile(F &&f) const {
        ForEachPixel({tilesX, tilesY}, f);
    }
    bool operator==(const TileGrid &) const = default;
};

/// Mean value of every tile and channel of one image.
struct TileMeans {
    TileGrid grid;
    int channels = 0;
    std::vector<double> values;  ///< tile by tile, the channels of a tile next to each other
    size_t skipped = 0;          ///< values that were not finite and were left out

    double operator()(int tile, int channel) const { return values[tile * channels + channel]; }
};

/// Returns the tile means of the channels R, G, B if the image has them, else of all channels. tileSize >= 8 keeps
/// tiles nearly independent under ordinary pixel filters.
TileMeans ComputeTileMeans(const Image &image, int tileSize = 8);

/// Mean of images of equal weight, and the relL2 that this mean is expected to have against the truth (from the
/// variance between the images; 0 if there is only one). Throws UserError if they do not match.
struct MeanImage {
    Image image;
    double noise = 0;
};
MeanImage AverageImages(std::span<const Image *const> images);

/// A rectangle of tiles, half-open.
struct TileRectangle {
    int x0, y0, x1, y1;
    int Count() const { return (x1 - x0) * (y1 - y0); }
    /// Calls f(x, y) for all tiles, row by row.
    template <class F>
    void ForEach(F &&f) const {
        for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) f(x, y);
    }
};

/// Returns the median of unsorted values; infinity if there are none.
double Median(std::vector<double> values);

/// Returns how far the largest of `values`, which scatter about 0, exceeds ordinary noise (three robust
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
    /// Returns the noise of the mean over a region; needs at least two pictures.
    Estimate Of(const TileRectangle &r) const;

    /// Returns the excess of the strongest tile of a single picture within `r`; needs at least two pictures.
    double Strongest(const TileRectangle &r) const;

  private:
    double Residual(size_t picture, int x, int y) const {
        return residual_[picture * mean_.size() + grid_.Index(x, y)];
    }
    TileGrid grid_;
    size_t n_ = 0;
    std::vector<double> mean_, residual_;
};

}  // namespace ext::lab
