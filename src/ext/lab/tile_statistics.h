#pragma once
#include <span>
#include <vector>

#include "pbrt/images/image.h"

namespace pbrt::lab {

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
    bool operator==(const TileGrid &) const = default;
};

/// Mean value of every tile and channel of one image.
struct TileMeans {
    TileGrid grid;
    int channels = 0;
    std::vector<double> values;  ///< tile by tile, the channels of a tile next to each other
    size_t skipped = 0;          ///< values that were not finite and were left out

    double operator()(int tile, int channel) const {
        return values[static_cast<size_t>(tile) * static_cast<size_t>(channels) + static_cast<size_t>(channel)];
    }
};

/// Tile means of the channels R, G, B if the image has them, else of all channels. tileSize >= 8 keeps tiles nearly
/// independent under ordinary pixel filters.
TileMeans ComputeTileMeans(const Image &image, int tileSize = 8);

/// Mean of images of equal weight, and the relL2 that this mean is expected to have against the truth (from the
/// variance between the images; 0 if there is only one). Throws UserError if they do not match.
struct MeanImage {
    Image image;
    double noise = 0;
};
MeanImage AverageImages(std::span<const Image *const> images);

}  // namespace pbrt::lab
