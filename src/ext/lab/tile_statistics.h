#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "pbrt/images/image.h"

namespace ext::lab {
using namespace pbrt;

/// Row by row.
void ForEachPixel(const Bounds2i &pixels, auto &&f) {
    for (int y = pixels.low.y; y < pixels.high.y; ++y)
        for (int x = pixels.low.x; x < pixels.high.x; ++x) f(x, y);
}
void ForEachPixel(Point2i resolution, auto &&f) { ForEachPixel(Bounds2i{{0, 0}, resolution}, f); }

/// Square tiles over an image. Remaining pixels at the right and bottom belong to the last tiles, so no tile is smaller
/// than kTileSize unless the image is.
struct TileGrid {
    static constexpr int kTileSize = 8;  ///< keeps tiles nearly independent under ordinary pixel filters
    Point2i resolution{0, 0};
    int tilesX = 0, tilesY = 0;

    TileGrid() = default;
    explicit TileGrid(Point2i size)
        : resolution(size), tilesX(std::max(1, size.x / kTileSize)), tilesY(std::max(1, size.y / kTileSize)) {}
    int Count() const { return tilesX * tilesY; }
    int Index(int x, int y) const { return y * tilesX + x; }
    Bounds2i Pixels(int x, int y) const;
    /// Calls f(index, pixels).
    void ForEachTile(auto &&f) const {
        ForEachPixel({tilesX, tilesY}, [&](int x, int y) { f(Index(x, y), Pixels(x, y)); });
    }
    bool operator==(const TileGrid &) const = default;
};

/// Mean value of every tile and channel of one image.
struct TileMeans {
    TileGrid grid;
    int channels = 0;
    std::vector<double> values;  ///< tile-major, channels interleaved

    double operator()(int tile, int channel) const { return values[tile * channels + channel]; }
};

/// Tile means of R, G, B if present, else of all channels, without non-finite values.
TileMeans ComputeTileMeans(const Image &image);
std::vector<TileMeans> TilesOf(std::span<const Image> images);

/// Mean of images of equal weight, and its expected relL2 (from the variance between the images; 0 for a single one).
/// Throws UserError if they do not match.
struct MeanImage {
    Image image;
    double noise = 0;
};
MeanImage AverageImages(std::span<const Image> images);

double Median(std::vector<double> values);  ///< median of unsorted values; infinity if empty

/// Excess of the largest of `values`, scattered about 0, over three robust standard deviations; at least 0.
double Excess(const std::vector<double> &values);

/// Mean and noise of weighted tile means of equally weighted images, one channel.
class TileNoise {
  public:
    TileNoise(std::span<const TileMeans> pictures, int channel, const std::vector<double> &weights);

    static constexpr size_t kFew = 4;  ///< fewer images often agree by chance where most of the noise is

    size_t Pictures() const { return n_; }
    double Mean(size_t tile) const { return mean_[tile]; }

    struct Estimate {
        double variance = 0, dof = 0;
    };
    Estimate Of(const Bounds2i &r) const;  ///< noise of the mean over a region of tiles; requires at least two images

    /// Excess of the strongest tile of a single image within `r`; requires at least two images.
    double Strongest(const Bounds2i &r) const;

  private:
    double Residual(size_t picture, int x, int y) const {
        return residual_[picture * mean_.size() + grid_.Index(x, y)];
    }
    TileGrid grid_;
    size_t n_ = 0;
    std::vector<double> mean_, residual_;
};

}  // namespace ext::lab
