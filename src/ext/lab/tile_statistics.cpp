#include "ext/lab/tile_statistics.h"

#include <cmath>
#include <limits>

#include "pbrt/images/metrics.h"

namespace ext::lab {

Bounds2i TileGrid::Pixels(int x, int y) const {
    const Point2i low = Point2i(x, y) * kTileSize, next = low + kTileSize;
    return {low, {x + 1 == tilesX ? resolution.x : next.x, y + 1 == tilesY ? resolution.y : next.y}};
}

TileMeans ComputeTileMeans(const Image &image) {
    const std::vector<int> channels = RgbOrAllChannels(image);
    TileMeans means{TileGrid(image.Resolution()), int(channels.size()), {}};
    means.values.reserve(means.grid.Count() * channels.size());
    means.grid.ForEachTile([&](int, const Bounds2i &pixels) {
        for (int c : channels) {
            FiniteMean mean;
            ForEachPixel(pixels, [&](int x, int y) { mean.Add(double(image.Get({x, y}, c))); });
            means.values.push_back(mean.Mean());
        }
    });
    return means;
}

std::vector<TileMeans> TilesOf(std::span<const Image> images) {
    std::vector<TileMeans> tiles;
    for (const Image &image : images) tiles.push_back(ComputeTileMeans(image));
    return tiles;
}

MeanImage AverageImages(std::span<const Image> images) {
    if (images.empty()) throw UserError("There is no image to average.");
    const Image &first = images[0];
    for (const Image &image : images)
        if (image.Resolution() != first.Resolution() || image.Channels() != first.Channels())
            throw UserError("Images of different resolution or channels cannot be averaged.");
    MeanImage out{Image(PixelFormat::Float, first.Resolution(), first.Channels())};
    const auto n = double(images.size());
    std::vector<double> variances;
    ForEachValue(first, [&](Point2i p, int c) {
        double sum = 0, squares = 0;
        for (const Image &image : images) sum += double(image.Get(p, c));
        const double mean = sum / n;
        for (const Image &image : images) squares += Sqr(double(image.Get(p, c)) - mean);
        out.image.Set(p, c, Float(mean));
        variances.push_back(n > 1 ? squares / (n - 1) / n : 0);
    });
    const double epsilon = RelL2Epsilon(out.image);
    FiniteMean noise;
    size_t i = 0;
    ForEachValue(out.image,
                 [&](Point2i p, int c) { noise.Add(variances[i++] / (Sqr(double(out.image.Get(p, c))) + epsilon)); });
    out.noise = noise.Mean();
    return out;
}

double Median(std::vector<double> values) {
    if (values.empty()) return std::numeric_limits<double>::infinity();
    auto middle = values.begin() + values.size() / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double Excess(const std::vector<double> &values) {
    constexpr double kDeviationPerMedian = 1.4826;  // of normal deviates: standard deviation over median absolute value
    double largest = 0;
    std::vector<double> sizes;
    for (double v : values) {
        largest = std::max(largest, v);
        sizes.push_back(std::abs(v));
    }
    return std::max(0.0, largest - 3 * kDeviationPerMedian * Median(std::move(sizes)));
}

TileNoise::TileNoise(std::span<const TileMeans> pictures, int channel, const std::vector<double> &weights)
    : grid_(pictures[0].grid), n_(pictures.size()) {
    const size_t tiles = grid_.Count();
    mean_.assign(tiles, 0);
    residual_.resize(n_ * tiles);
    for (size_t t = 0; t < tiles; ++t) {
        for (size_t i = 0; i < n_; ++i) {
            residual_[i * tiles + t] = weights[t] * pictures[i](int(t), channel);
            mean_[t] += residual_[i * tiles + t] / double(n_);
        }
        for (size_t i = 0; i < n_; ++i) residual_[i * tiles + t] -= mean_[t];
    }
}

TileNoise::Estimate TileNoise::Of(const Bounds2i &r) const {
    const auto n = double(n_);
    double own = 0, ownSquared = 0, neighbours = 0, between = 0;
    for (size_t i = 0; i < n_; ++i) {
        double total = 0;
        ForEachPixel(r, [&](int x, int y) {
            const double e = Residual(i, x, y);
            total += e;
            // Each pair once; the factor 2 below accounts for the other half.
            if (x + 1 < r.high.x) neighbours += e * Residual(i, x + 1, y);
            if (y + 1 < r.high.y) {
                neighbours += e * Residual(i, x, y + 1);
                if (x + 1 < r.high.x) neighbours += e * Residual(i, x + 1, y + 1);
                if (x > r.low.x) neighbours += e * Residual(i, x - 1, y + 1);
            }
        });
        between += total * total;
    }
    double bright = 0, brightSquared = 0;
    ForEachPixel(r, [&](int x, int y) {
        double squares = 0;
        for (size_t i = 0; i < n_; ++i) squares += Sqr(Residual(i, x, y));
        own += squares;
        ownSquared += squares * squares;
        const double mean = Mean(grid_.Index(x, y)), expected = mean * mean;
        bright += expected;
        brightSquared += expected * expected;
    });
    Estimate noise;
    const double tiles = double(r.Area());
    const double sum = std::max(own + std::max(0.0, 2 * neighbours), between);
    noise.variance = sum / (n * (n - 1) * tiles * tiles);
    // Satterthwaite's estimate from squares that are too large by (n + 1) / (n - 1), being estimates themselves; exact
    // for equal tiles ((n - 1) tiles - 2) and if one tile has all the noise (n - 1).
    if (ownSquared > 0) noise.dof = std::min((n + 1) * own * own / ownSquared - 2, (n - 1) * tiles);
    // Few images often agree by chance where most of the noise is; many quiet tiles then dominate. So the region's
    // degrees of freedom are limited to those of noise proportional to brightness.
    if (n_ < kFew && brightSquared > 0) noise.dof = std::min(noise.dof, (n - 1) * bright * bright / brightSquared);
    return noise;
}

double TileNoise::Strongest(const Bounds2i &r) const {
    std::vector<double> values;
    for (size_t i = 0; i < n_; ++i) ForEachPixel(r, [&](int x, int y) { values.push_back(Residual(i, x, y)); });
    // The image with the strong sample has itself raised the mean, by 1/n of it.
    return double(n_) / double(n_ - 1) * Excess(values);
}

}  // namespace ext::lab
