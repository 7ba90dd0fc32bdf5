#include <cmath>

#include "pbrt/cmd/imgtool/commands.h"
#include "pbrt/core/files.h"
#include "pbrt/core/log.h"
#include "pbrt/spectra/rgb_primaries.h"

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
    for (int i = -radius; i <= radius; ++i) weights.push_back(Float(std::exp(-i * i / (2 * sigma * sigma)) / sum));
    return weights;
}

/// Blurs along one axis. Light blurred over the edge is lost.
Image Blur(const Image &image, const std::vector<Float> &weights, Point2i axis) {
    Image result(PixelFormat::Float, image.Resolution(), image.Channels());
    const int radius = int(weights.size()) / 2;
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
        throw UserError("--width {}: an odd number is needed, so that the light stays in place.", o.width);
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
    if (count == 0) LogWarning("{}: no pixel is brighter than --level {}; nothing blooms.", o.path, o.level);

    const std::vector<Float> weights = Gaussian(o.width);
    for (int i = 0; i < o.iterations && count > 0; ++i) {
        bright = Blur(Blur(bright, weights, {1, 0}), weights, {0, 1});
        const Float share = o.scale / Float(o.iterations);
        ForEachPixel(bright, [&](Point2i p) {
            SetRgb(file.image, p, rgb, GetRgb(file.image, p, rgb) + share * GetRgb(bright, p, {0, 1, 2}));
        });
    }
    WriteImage(o.outfile, file.image, file.metadata);
    fmt::print("{}: {} in bloom\n", o.outfile, CountText(count, "pixel"));
    return 0;
}

struct WhitebalanceOptions {
    std::string path, outfile, illuminant;
    std::vector<Float> primaries;
    std::optional<Float> temperature;
};

/// The prefix of a name is optional: A is stdillum-A.
Point2 WhiteOfIlluminant(const std::string &name) {
    std::vector<std::string> choices;
    for (const std::string &known : NamedSpectrumNames())
        if (known.starts_with("stdillum-") || known.starts_with("illum-")) {
            choices.push_back(known);
            if (name == known || name == known.substr(known.find('-') + 1))
                return Chromaticity(SpectrumToXyz(*NamedSpectrum(known)));
        }
    throw UserError("--illuminant {}: unknown; {}", name, ListChoices(name, choices));
}

Point2 White(const WhitebalanceOptions &o) {
    if (!o.illuminant.empty()) return WhiteOfIlluminant(o.illuminant);
    if (o.temperature) return Chromaticity(SpectrumToXyz(DaylightSpectrum(*o.temperature)));
    if (o.primaries.empty()) throw UserError("One of --illuminant, --primaries and --temperature is needed.");
    const Point2 white(o.primaries[0], o.primaries[1]);
    if (!(white.x > 0 && white.y > 0 && white.x + white.y < 1))
        throw UserError("--primaries {},{}: not the chromaticity of a white; x and y are above 0 and x + y below 1.",
                        white.x, white.y);
    return white;
}

int Whitebalance(const WhitebalanceOptions &o) {
    const Point2 white = White(o);
    ImageFile file = ReadAsFloat(o.path);
    const std::array<int, 3> rgb = RgbChannels(file.image, o.path);
    const ColorSpace &space = SpaceOf(file);
    const glm::mat3 m = space.RgbFromXyz() * WhiteBalanceMatrix(white, space.White()) * space.XyzFromRgb();
    ForEachPixel(file.image, [&](Point2i p) { SetRgb(file.image, p, rgb, m * GetRgb(file.image, p, rgb)); });
    WriteImage(o.outfile, file.image, file.metadata);
    return 0;
}

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
        out[i] = uint8_t(std::lround(std::clamp(values[i], 0.f, 1.f) * 255));
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
    if (LowerExtension(o.outfile) == ".png") WriteLinearPng(o.outfile, image);
    else WriteImage(o.outfile, keepHalf ? image.ConvertTo(PixelFormat::Half) : image, file.metadata);
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
              ValidRange{1, 1 << 12})
             .ShowDefault(),
         Flag("--iterations", o.iterations,
              "How often the bright pixels are blurred; the mean of all these images is added", ValidRange{1, 1000})
             .ShowDefault(),
         Flag("--scale", o.scale, "What is added is multiplied by this", NonNegativeNumber).ShowDefault()});
}

void AddWhitebalance(CLI::App &app, Action &action) {
    auto [command, o] = AddCommand(app, action, Whitebalance, "whitebalance",
                                   "Turn the white of a given light into the white of the image's colour space",
                                   "Adaptation after von Kries in Bradford's cone space.\n"
                                   "Example: imgtool whitebalance lamp.exr --temperature 2800 --outfile white.exr");
    AddFlags(
        command,
        {Flag("file", o.path, "Image with the channels R, G, B").Required(),
         OutfileFlag(o.outfile, true),
         Flag("--illuminant", o.illuminant, "The light: a standard illuminant, for instance A or D50").Type("NAME"),
         Flag("--primaries", o.primaries, "The light: its chromaticity").Count(2).Type("x,y"),
         {"--temperature", o.temperature, "The light: daylight of this temperature in kelvin, below 4000 a black body",
          ValidRange{1000.0, 25000.0}}});
    CLI::Option *primaries = command.get_option("--primaries"), *temperature = command.get_option("--temperature");
    command.get_option("--illuminant")->excludes(primaries)->excludes(temperature);
    primaries->excludes(temperature);
}

void AddScalenormalmap(CLI::App &app, Action &action) {
    auto [command, o] =
        AddCommand(app, action, Scalenormalmap, "scalenormalmap", "Make the relief of a normal map stronger or weaker",
                   "Example: imgtool scalenormalmap bricks.png --scale 0.5 --outfile softer.png");
    AddFlags(command, {Flag("file", o.path, "Normal map: R, G, B = (normal + 1) / 2, without sRGB encoding").Required(),
                       OutfileFlag(o.outfile, true),
                       Flag("--scale", o.scale, "Slopes are multiplied by this; 0 gives a flat map").ShowDefault()});
}

}  // namespace pbrt::imgtool
