#include "ext/lab/tile_statistics.h"

#include <algorithm>
#include <cmath>

#include "pbrt/core/error.h"
#include "pbrt/images/metrics.h"

namespace pbrt::lab {

TileGrid::TileGrid(Point2i resolution, int tileSize) : resolution(resolution), tileSize(tileSize) {
    tilesX = std::max(1, resolution.x / tileSize);
    tilesY = std::max(1, resolution.y / tileSize);
}

Bounds2i TileGrid::Pixels(int x, int y) const {
    return Bounds2i({x * tileSize, y * tileSize}, {x + 1 == tilesX ? resolution.x : (x + 1) * tileSize,
                                                   y + 1 == tilesY ? resolution.y : (y + 1) * tileSize});
}

TileMeans ComputeTileMeans(const Image &image, int tileSize) {
    std::vector<int> channels;
    for (const char *name : {"R", "G", "B"})
        if (int c = image.FindChannel(name); c >= 0) channels.push_back(c);
    if (channels.size() < 3) {
        channels.clear();
        for (int c = 0; c < image.ChannelCount(); ++c) channels.push_back(c);
    }
    TileMeans means;
    means.grid = TileGrid(image.Resolution(), tileSize);
    means.channels = static_cast<int>(channels.size());
    means.values.reserve(static_cast<size_t>(means.grid.Count()) * channels.size());
    for (int ty = 0; ty < means.grid.tilesY; ++ty)
        for (int tx = 0; tx < means.grid.tilesX; ++tx) {
            const Bounds2i pixels = means.grid.Pixels(tx, ty);
            for (int c : channels) {
                double sum = 0;
                size_t counted = 0;
                for (int y = pixels.low.y; y < pixels.high.y; ++y)
                    for (int x = pixels.low.x; x < pixels.high.x; ++x) {
                        const auto v = static_cast<double>(image.Get({x, y}, c));
                        if (std::isfinite(v)) {
                            sum += v;
                            ++counted;
                        } else {
                            ++means.skipped;
                        }
                    }
                means.values.push_back(counted ? sum / static_cast<double>(counted) : 0);
            }
        }
    return means;
}

MeanImage AverageImages(std::span<const Image *const> images) {
    if (images.empty()) throw UserError("There is no image to average.");
    const Image &first = *images[0];
    for (const Image *image : images)
        if (image->Resolution() != first.Resolution() || image->Channels() != first.Channels())
            throw UserError("Images of different resolution or channels cannot be averaged.");
    MeanImage out{Image(PixelFormat::Float, first.Resolution(), first.Channels())};
    const auto n = static_cast<double>(images.size());
    std::vector<double> variances;
    for (int y = 0; y < first.Resolution().y; ++y)
        for (int x = 0; x < first.Resolution().x; ++x)
            for (int c = 0; c < first.ChannelCount(); ++c) {
                double sum = 0, squares = 0;
                for (const Image *image : images) sum += static_cast<double>(image->Get({x, y}, c));
                const double mean = sum / n;
                for (const Image *image : images) {
                    const double d = static_cast<double>(image->Get({x, y}, c)) - mean;
                    squares += d * d;
                }
                out.image.Set({x, y}, c, static_cast<Float>(mean));
                variances.push_back(n > 1 ? squares / (n - 1) / n : 0);
            }
    const double epsilon = RelL2Epsilon(out.image);
    double noise = 0;
    size_t counted = 0, i = 0;
    for (int y = 0; y < first.Resolution().y; ++y)
        for (int x = 0; x < first.Resolution().x; ++x)
            for (int c = 0; c < first.ChannelCount(); ++c) {
                const double term = variances[i++] / (Sqr(static_cast<double>(out.image.Get({x, y}, c))) + epsilon);
                if (!std::isfinite(term)) continue;
                noise += term;
                ++counted;
            }
    out.noise = counted ? noise / static_cast<double>(counted) : 0;
    return out;
}

}  // namespace pbrt::lab
