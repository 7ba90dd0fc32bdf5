#include <cmath>
#include <filesystem>

#include "pbrt/cmd/imgtool/commands.h"

namespace pbrt::imgtool {

namespace {

struct ScalenormalmapOptions {
    std::string path, outfile;
    Float scale = 1;
};

/// PNG bytes are 255 times the values: normal maps have no sRGB encoding.
void WriteLinearPng(const std::string &path, const Image &image) {
    Image bytes(PixelFormat::U8, image.Resolution(), image.Channels());
    auto *out = static_cast<uint8_t *>(bytes.Data());
    const auto *values = static_cast<const float *>(image.Data());
    for (size_t i = 0; i < image.ValueCount(); ++i)
        out[i] = static_cast<uint8_t>(std::lround(std::clamp(values[i], 0.f, 1.f) * 255));
    WriteImage(path, bytes);
}

int Scalenormalmap(const ScalenormalmapOptions &o) {
    ImageFile file = ReadImage(o.path, ColorEncoding{ColorEncoding::Kind::Linear});
    const bool keepHalf = file.image.Format() != PixelFormat::Float;
    Image &image = file.image;
    image = image.ConvertTo(PixelFormat::Float);
    const std::array<int, 3> rgb = RgbChannels(image, o.path);
    ForEachPixel(image, [&](Point2i p) {
        Vector3 n = GetRgb(image, p, rgb) * Float(2) - Vector3(1);
        n.x *= o.scale;
        n.y *= o.scale;
        const Float length = Length(n);
        if (length > 0) n /= length;
        SetRgb(image, p, rgb, (n + Vector3(1)) / Float(2));
    });
    if (std::filesystem::path(o.outfile).extension() == ".png") WriteLinearPng(o.outfile, image);
    else WriteImage(o.outfile, keepHalf ? image.ConvertTo(PixelFormat::Half) : image, file.metadata);
    return 0;
}

}  // namespace

void AddScalenormalmap(CLI::App &app, Action &action) {
    auto [command, o] =
        AddCommand(app, action, Scalenormalmap, "scalenormalmap", "Make the relief of a normal map stronger or weaker",
                   "Example: imgtool scalenormalmap bricks.png --scale 0.5 --outfile softer.png");
    AddFlags(command, {Flag("file", o.path, "Normal map: R, G, B = (normal + 1) / 2, without sRGB encoding").Required(),
                       OutfileFlag(o.outfile, true),
                       Flag("--scale", o.scale, "Slopes are multiplied by this; 0 gives a flat map").ShowDefault()});
}

}  // namespace pbrt::imgtool
