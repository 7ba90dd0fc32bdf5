#include <cmath>

#include "pbrt/cmd/imgtool/commands.h"
#include "pbrt/core/log.h"

namespace pbrt::imgtool {

namespace {

struct BloomOptions {
    std::string path, outfile;
    int iterations = 5, width = 15;
    Float level = Infinity, scale = Float(0.3);
};

/// Gaussian over an odd number of pixels, sum 1, truncated at three standard deviations.
std::vector<Float> Gaussian(int width) {
    const int radius = width / 2;
    const double sigma = std::max(width / 6.0, 1e-3);
    std::vector<Float> weights;
    double sum = 0;
    for (int i = -radius; i <= radius; ++i) sum += std::exp(-i * i / (2 * sigma * sigma));
    for (int i = -radius; i <= radius; ++i)
        weights.push_back(static_cast<Float>(std::exp(-i * i / (2 * sigma * sigma)) / sum));
    return weights;
}

/// Blurs along one axis. Light blurred over the edge is lost.
Image Blur(const Image &image, const std::vector<Float> &weights, Point2i axis) {
    Image result(PixelFormat::Float, image.Resolution(), image.Channels());
    const int radius = static_cast<int>(weights.size()) / 2;
    const int last = axis.x ? image.Resolution().x - 1 : image.Resolution().y - 1;
    ForEachPixel(image, [&](Point2i p) {
        const int at = axis.x ? p.x : p.y;
        const int low = std::max(-radius, -at), high = std::min(radius, last - at);
        for (int c = 0; c < image.ChannelCount(); ++c) {
            Float sum = 0;
            for (int i = low; i <= high; ++i) sum += weights[i + radius] * image.Get(p + axis * i, c);
            result.Set(p, c, sum);
        }
    });
    return result;
}

int Bloom(const BloomOptions &o) {
    if (o.width % 2 == 0)
        throw UserError(fmt::format("--width {}: an odd number is needed, so that the light stays in place.", o.width));
    ImageFile file = ReadAsFloat(o.path);
    const std::array<int, 3> rgb = RgbChannels(file.image, o.path);

    Image bright(PixelFormat::Float, file.image.Resolution(), {"R", "G", "B"});
    size_t count = 0;
    ForEachPixel(bright, [&](Point2i p) {
        const Rgb color = GetRgb(file.image, p, rgb);
        // NaN and infinity would spread to neighbours.
        if (!(std::max({color.x, color.y, color.z}) > o.level) || !std::isfinite(color.x + color.y + color.z)) return;
        ++count;
        SetRgb(bright, p, {0, 1, 2}, color);
    });
    if (count == 0)
        LogWarning(fmt::format("{}: no pixel is brighter than --level {}; nothing blooms.", o.path, o.level));

    const std::vector<Float> weights = Gaussian(o.width);
    for (int i = 0; i < o.iterations && count > 0; ++i) {
        bright = Blur(Blur(bright, weights, {1, 0}), weights, {0, 1});
        const Float share = o.scale / static_cast<Float>(o.iterations);
        ForEachPixel(bright, [&](Point2i p) {
            SetRgb(file.image, p, rgb, GetRgb(file.image, p, rgb) + share * GetRgb(bright, p, {0, 1, 2}));
        });
    }
    WriteImage(o.outfile, file.image, file.metadata);
    fmt::print("{}: {} in bloom\n", o.outfile, CountText(count, "pixel"));
    return 0;
}

}  // namespace

void AddBloom(CLI::App &app, Action &action) {
    auto [command, o] = AddCommand(app, action, Bloom, "bloom", "Let bright pixels shine into their surroundings",
                                   "Example: imgtool bloom render.exr --level 10 --width 31 --outfile bloom.exr");
    AddFlags(
        command,
        {Flag("file", o.path, "Image with the channels R, G, B").Required(), OutfileFlag(o.outfile, true),
         Flag("--level", o.level, "Pixels bloom if R, G or B is above this").ShowDefault(),
         Flag("--width", o.width, "Width of the blur in pixels (odd); its standard deviation is a sixth",
              CLI::Range(1, 1 << 12))
             .ShowDefault(),
         Flag("--iterations", o.iterations,
              "How often the bright pixels are blurred; the mean of all these pictures is added", CLI::Range(1, 1000))
             .ShowDefault(),
         Flag("--scale", o.scale, "What is added is multiplied by this", CLI::NonNegativeNumber).ShowDefault()});
}

}  // namespace pbrt::imgtool
