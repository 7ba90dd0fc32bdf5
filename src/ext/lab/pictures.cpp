#include "ext/lab/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ext/lab/tile_statistics.h"
#include "pbrt/core/files.h"
#include "pbrt/images/false_color.h"
#include "pbrt/images/metrics.h"

namespace ext::lab {

namespace {

template <class T>
double Percentile(std::vector<T> values, double share) {
    if (values.empty()) return 0;
    auto at = values.begin() + static_cast<ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return static_cast<double>(*at);
}

}  // namespace

double ChooseExposure(const Image &reference) {
    const Rgb weights = ColorSpace::SRGB().Luminance();
    std::vector<float> luminances;
    ForEachPixel(reference.Resolution(), [&](int x, int y) {
        Float l = 0;
        for (int c = 0; c < 3; ++c) l += weights[c] * reference.Get({x, y}, c);
        if (std::isfinite(l) && l > 0) luminances.push_back(l);
    });
    if (luminances.empty()) return 1;
    const double middle = Percentile(luminances, 0.5), high = Percentile(luminances, 0.75),
                 bright = Percentile(luminances, 0.98);
    return std::max(0.9 / bright, std::min(0.18 / middle, 0.9 / high));
}

void WritePicture(const std::string &path, const Image &image, double exposure) {
    Image shown(PixelFormat::Float, image.Resolution(), {"R", "G", "B"});
    ForEachPixel(image.Resolution(), [&](int x, int y) {
        for (int c = 0; c < 3; ++c)
            shown.Set({x, y}, c, std::clamp(image.Get({x, y}, c) * static_cast<Float>(exposure), Float(0), Float(1)));
    });
    WriteImage(path, shown);
}

void WriteRangePicture(const std::string &path, const Image &image) {
    const Point2i resolution = image.Resolution();
    std::string text = fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", resolution.y, resolution.x);
    ForEachPixel(resolution, [&](int x, int y) {
        double color[3], brightest = 0;
        for (int c = 0; c < 3; ++c) {
            const auto v = static_cast<double>(image.Get({x, y}, c));
            color[c] = std::isfinite(v) ? std::max(v, 0.0) : 0;
            brightest = std::max(brightest, color[c]);
        }
        int exponent = 0;
        std::frexp(brightest, &exponent);
        const bool isBlack = !(brightest > 0) || exponent < -127;
        const int stored = std::min(exponent, 127) + 128;
        for (double v : color) {
            const double byte = isBlack ? 0 : std::min(std::floor(std::ldexp(v, 8 - (stored - 128))), 255.0);
            text += static_cast<char>(static_cast<uint8_t>(byte));
        }
        text += static_cast<char>(static_cast<uint8_t>(isBlack ? 0 : stored));
    });
    WriteFile(path, text);
}

std::vector<float> ErrorMap(const Image &image, const Image &reference) {
    std::vector<float> map;
    const Point2i resolution = image.Resolution();
    const double epsilon = RelL2Epsilon(reference);
    map.reserve(resolution.x * resolution.y);
    ForEachPixel(resolution, [&](int x, int y) {
        double sum = 0;
        for (int c = 0; c < 3; ++c) {
            const double r = double(reference.Get({x, y}, c)), d = double(image.Get({x, y}, c)) - r;
            sum += d * d / (r * r + epsilon);
        }
        map.push_back(std::isfinite(sum) ? static_cast<float>(std::sqrt(sum / 3)) : 0.f);
    });
    return map;
}

double ChooseErrorScale(std::span<const std::vector<float>> maps) {
    double most = 0;
    for (const std::vector<float> &map : maps) most = std::max(most, Percentile(map, 0.99));
    return most > 0 ? most : 1;
}

void WriteErrorPicture(const std::string &path, const std::vector<float> &map, Point2i resolution, double most) {
    Image values(PixelFormat::Float, resolution, {"Y"});
    size_t i = 0;
    ForEachPixel(resolution, [&](int x, int y) { values.Set({x, y}, 0, map[i++]); });
    FalseColorStyle style;
    style.most = static_cast<Float>(most);
    WriteImage(path, FalseColor(values, 0, style));
}

std::vector<Bounds2i> ChooseCrops(std::span<const std::vector<float>> maps, Point2i resolution) {
    const int shorter = std::min(resolution.x, resolution.y);
    const int side = std::min(shorter, std::min(64, std::max(8, shorter / 4)));
    const int step = std::max(1, side / 2);
    struct Candidate {
        Bounds2i pixels;
        double score;
    };
    std::vector<Candidate> candidates;
    for (int y = 0; y + side <= resolution.y; y += step)
        for (int x = 0; x + side <= resolution.x; x += step) {
            double least = std::numeric_limits<double>::infinity(), most = 0;
            for (const std::vector<float> &map : maps) {
                double sum = 0;
                for (int v = y; v < y + side; ++v)
                    for (int u = x; u < x + side; ++u) {
                        const double e = double(map[v * resolution.x + u]);
                        sum += e * e;
                    }
                least = std::min(least, sum);
                most = std::max(most, sum);
            }
            if (!maps.empty())
                candidates.push_back({{{x, y}, {x + side, y + side}}, std::sqrt(most) - std::sqrt(least)});
        }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate &a, const Candidate &b) { return a.score > b.score; });
    std::vector<Bounds2i> crops;
    for (const Candidate &c : candidates) {
        const bool isFree = std::none_of(crops.begin(), crops.end(), [&](const Bounds2i &o) {
            return c.pixels.low.x < o.high.x && o.low.x < c.pixels.high.x && c.pixels.low.y < o.high.y &&
                   o.low.y < c.pixels.high.y;
        });
        if (isFree) crops.push_back(c.pixels);
        if (crops.size() == 3) break;
    }
    return crops;
}

}  // namespace ext::lab
