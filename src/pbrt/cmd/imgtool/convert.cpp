#include <cmath>
#include <limits>

#include "pbrt/cmd/imgtool/commands.h"

namespace pbrt::imgtool {
namespace {

struct ConvertOptions {
    std::string path, outfile, channels;
    std::vector<int> crop;
    Float scale = 1, exposure = 0, gamma = 1;
    std::optional<Float> clamp, maxLuminance;
    bool tonemap = false, blackAndWhite = false, flipY = false, half = false;
    int repeat = 1;
};

void MapColors(Image &image, auto &&f) {
    const std::vector<int> colors = ColorChannels(image);
    ForEachPixel(image, [&](Point2i p) {
        for (int c : colors) image.Set(p, c, f(image.Get(p, c)));
    });
}

// Clamps magnitudes: R, G and B of a pixel by a common factor, which preserves hue; other channels separately.
void Clamp(Image &image, Float limit) {
    if (image.HasRgb())
        ForEachPixel(image, [&, rgb = RgbChannels(image, "")](Point2i p) {
            const Rgb color = GetRgb(image, p, rgb);
            const Float largest = MaxComponent(glm::abs(color));
            if (largest > limit && std::isfinite(largest)) SetRgb(image, p, rgb, color / largest * limit);
        });
    MapColors(image, [&](Float v) { return std::clamp(v, -limit, limit); });
}

// Reinhard et al. 2002, eq. 4: luminance L becomes L (1 + L / max^2) / (1 + L), mapping `maxLuminance` to 1. Default:
// the image's maximum luminance, at least 1.
void Tonemap(Image &image, std::optional<Float> maxLuminance, const ColorSpace &space) {
    const int r = image.FindChannel("R"), g = image.FindChannel("G"), b = image.FindChannel("B");
    const bool color = r >= 0 && g >= 0 && b >= 0;
    if (!color && image.ChannelCount() != 1)
        throw UserError("--tonemap needs the channels R, G and B or a single channel.");
    const Rgb weights = space.Luminance();
    const std::vector<int> scaled = color ? std::vector<int>{r, g, b} : std::vector<int>{0};
    auto luminanceOf = [&](Point2i p) {
        return std::max(color ? glm::dot(weights, GetRgb(image, p, {r, g, b})) : image.Get(p, 0), Float(0));
    };
    Float white = maxLuminance.value_or(1);
    if (!maxLuminance)
        ForEachPixel(image, [&](Point2i p) {
            if (const Float luminance = luminanceOf(p); std::isfinite(luminance)) white = std::max(white, luminance);
        });
    ForEachPixel(image, [&](Point2i p) {
        const Float luminance = std::min(luminanceOf(p), std::numeric_limits<Float>::max());
        const Float factor = (1 + luminance / Sqr(white)) / (1 + luminance);
        for (int c : scaled) image.Set(p, c, image.Get(p, c) * factor);
    });
}

Image Rearrange(const Image &image, Point2i resolution, auto &&source) {
    Image result(image.Format(), resolution, image.Channels());
    ForEachPixel(result, [&](Point2i p) {
        for (int c = 0; c < image.ChannelCount(); ++c) result.Set(p, c, image.Get(source(p), c));
    });
    return result;
}

int Convert(const ConvertOptions &o) {
    ImageFile file = ReadImage(o.path);
    const bool keepHalf = file.image.Format() != PixelFormat::Float;
    Image &image = file.image;
    image = image.ConvertTo(PixelFormat::Float);
    ApplyCrop(file, o.crop, o.path);
    if (!o.channels.empty()) image = image.Select(SplitChannels(o.channels), o.path + ":");
    const ColorSpace &space = SpaceOf(file);
    if (const Float scale = o.scale * std::exp2(o.exposure); scale != 1)
        MapColors(image, [&](Float v) { return v * scale; });
    if (o.clamp) Clamp(image, *o.clamp);
    if (o.tonemap) Tonemap(image, o.maxLuminance, space);
    if (o.gamma != 1) MapColors(image, [&](Float v) { return std::pow(std::max(v, Float(0)), o.gamma); });
    if (o.blackAndWhite) image = AverageChannels(image);
    if (o.flipY) {
        const int last = image.Resolution().y - 1;
        image = Rearrange(image, image.Resolution(), [&](Point2i p) { return Point2i(p.x, last - p.y); });
        if (std::optional<Bounds2i> &window = file.metadata.pixelBounds) {
            const int height = file.metadata.fullResolution->y;
            window = {{window->low.x, height - window->high.y}, {window->high.x, height - window->low.y}};
        }
    }
    if (o.repeat > 1) {
        // Also of the corner of a part of an image.
        int64_t side = std::max(image.Resolution().x, image.Resolution().y);
        if (const std::optional<Bounds2i> &window = file.metadata.pixelBounds)
            for (const int v : {window->low.x, window->low.y, window->high.x, window->high.y})
                side = std::max(side, std::abs(int64_t{v}));
        if (side * o.repeat > kMaxImageSide) throw UserError("--repeatpix {}: the image becomes too large.", o.repeat);
        image = Rearrange(image, image.Resolution() * o.repeat, [&](Point2i p) { return p / o.repeat; });
        if (std::optional<Bounds2i> &window = file.metadata.pixelBounds)
            window = {window->low * o.repeat, window->high * o.repeat};
        if (file.metadata.fullResolution) *file.metadata.fullResolution *= o.repeat;
    }
    if (o.half || keepHalf) image = image.ConvertTo(PixelFormat::Half);
    WriteImage(o.outfile, image, file.metadata);
    return 0;
}

}  // namespace

void AddConvert(CLI::App &app, Action &action) {
    auto [command, o] =
        AddCommand(app, action, Convert, "convert", "Change an image or its file format",
                   "The changes happen in the order listed.\n"
                   "Example: imgtool convert render.exr view.png --crop 0,200,0,100 --exposure 1.5 --tonemap");
    AddFlags(
        command,
        {Flag("file", o.path, "Image").Required(),
         OutfileFlag(o.outfile, true),
         CropFlag(o.crop),
         Flag("--channels", o.channels, "Keep only these channels, in this order").Type("R,G,B"),
         Flag("--scale", o.scale, "Multiply colours by this").ShowDefault(),
         Flag("--exposure", o.exposure,
              "Stops by which the image becomes brighter: multiply colours by 2 to this power",
              ValidRange{-100.0, 100.0})
             .ShowDefault(),
         {"--clamp", o.clamp, "Scale R, G and B of brighter pixels so that the largest is this; limit other channels",
          NonNegativeNumber},
         {"--tonemap", o.tonemap, "Reinhard's tone mapping: compress luminances to 0 .. 1"},
         {"--maxluminance", o.maxLuminance,
          "Luminance that --tonemap maps to 1 (default: the largest of the image, at least 1)", PositiveNumber},
         Flag("--gamma", o.gamma, "Raise colours to this power", PositiveNumber).ShowDefault(),
         {"--bw", o.blackAndWhite, "Average the colour channels into one"},
         {"--flipy", o.flipY, "Turn upside down"},
         Flag("--repeatpix", o.repeat, "Repeat every pixel n times in both directions", ValidRange{1, 1 << 16})
             .ShowDefault(),
         {"--fp16", o.half, "Write half precision (otherwise the precision of the input stays)"}});
    command.get_option("--maxluminance")->needs(command.get_option("--tonemap"));
}

}  // namespace pbrt::imgtool
